//! Responses of designs: estimates with standard errors and intervals, for optimisers.
//!
//! A design is the study with values for its variables. The runs of all designs have the same start states and the same
//! draws of uncertain parameters, because draws are keyed by names and not by designs (common random numbers).
//!
//! Read `request` and `respond` first: a design that is asked for, and the computation of its responses.
//! `discontinuity` finds abrupt changes between designs, in a table or from one request to the next, and
//! `respond_to_all` flags them in a table of designs. `columns` and `answer_json` write the answers.

mod answer_json;
pub(crate) mod columns;
mod discontinuity;
mod request;
mod respond;
mod respond_to_all;

pub use answer_json::to_json;
pub(crate) use answer_json::{add_known, design_json, merged, point_keys};
pub use columns::response_columns;
pub use discontinuity::{MOST_DESIGNS, Neighbours, discontinuous};
pub use request::{Request, RequestError};
pub use respond::{Answer, DesignToEvaluate, respond, respond_in_order};
pub use respond_to_all::{check_answerable, respond_to_all, run_count};
