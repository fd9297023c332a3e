//! Responses of designs: estimates with standard errors and intervals, for optimisers.
//!
//! A design is the study with values for its variables. The runs of all designs have the same start states and the same
//! draws of uncertain parameters, because draws are keyed by names and not by designs (common random numbers).
//!
//! Read `request` and `respond` first: a design that is asked for, and the computation of its responses.
//! `discontinuity` finds abrupt changes between designs, in a table or from one request to the next. `columns` writes
//! the answers.

pub(crate) mod columns;
mod discontinuity;
mod request;
mod respond;

pub(crate) use columns::{add_known, design_json, merged, point_keys};
pub use columns::{response_columns, to_json};
pub use discontinuity::{MOST_DESIGNS, Neighbours, discontinuous};
pub use request::{Request, RequestError};
pub use respond::{
    Answer, DesignToEvaluate, check_answerable, respond, respond_in_order, respond_to_all,
    run_count,
};
