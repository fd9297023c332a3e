//! `docs/validation.md`: comparison of the thesis with the program, number by number, from real
//! runs.

mod counts;
mod endings;
mod numbers;
mod preferred;

use crate::docs::generated::compare_or_write;

/// The page agrees with the computed runs, and the required properties hold.
#[test]
fn generated_validation_page() {
    let runs = counts::ThesisRuns::compute();
    let page = [
        numbers::introduction(),
        numbers::closed_forms(),
        numbers::equilibrium_sets(),
        numbers::frictionless(),
        runs.counts(),
        preferred::near_frictionless(runs.by_default()),
        runs.times_to_rest(),
        endings::at_rest_over_time(),
        endings::thesis_orbits(),
        endings::cycles(),
        endings::block_on_belt(),
        runs.flips(),
        counts::independent_program(),
        numbers::remainder(),
    ];
    compare_or_write("docs/validation.md", &page.join("\n"));
    runs.must_agree();
    runs.must_be_near_the_thesis();
}
