mod block_closed_form;
mod existence;
mod extended_lagrange;
