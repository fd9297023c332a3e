mod existence;
mod extended_lagrange;
