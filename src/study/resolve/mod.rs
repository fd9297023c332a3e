//! From the study file to the study: every key validated, every default filled in.
//!
//! Read first `whole_study`, which calls `planned_runs` (model, sweep, start states, draws) and then the files of the other
//! keys. `system` reads system files.

pub(in crate::study) mod contact_laws;
pub(in crate::study) mod determined;
pub(in crate::study) mod expectations;
pub(in crate::study) mod further_errors;
pub(in crate::study) mod model;
pub(in crate::study) mod names;
pub(in crate::study) mod planned_runs;
pub(in crate::study) mod points;
pub(in crate::study) mod responses;
pub(in crate::study) mod runs;
pub(in crate::study) mod sampling;
pub(in crate::study) mod searches;
pub(in crate::study) mod stages;
pub(in crate::study) mod sweep;
pub(in crate::study) mod system;
mod system_drawing;
mod system_parts;
pub(in crate::study) mod uncertain;
pub(in crate::study) mod uncertain_sampling;
pub(in crate::study) mod units;
pub(in crate::study) mod variables;
pub(in crate::study) mod whole_study;

pub(in crate::study) use system::built_in_system;
