//! Closed forms and findings before a study is computed.

mod ball_fit;
mod closed_form;
mod equilibria;
mod obstacle;
mod points;
mod steady;
