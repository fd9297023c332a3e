//! `docs/validation.md`: comparison of the thesis with the program, number by number, from real
//! runs.

mod counts;
mod endings;
mod numbers;
mod preferred;

use crate::docs::generated::compare_or_write_part;

/// The numbers of the page agree with the computed runs, and the required properties hold.
#[test]
fn generated_validation_page() {
    let compare = |part: &str, computed: &str| {
        compare_or_write_part("docs/validation.md", part, computed);
    };
    let runs = counts::ThesisRuns::compute();
    for (part, table) in [
        ("closed-forms", numbers::closed_forms()),
        ("equilibrium-sets", numbers::equilibrium_sets()),
        ("frictionless", numbers::frictionless()),
        ("counts", runs.counts()),
        ("near-frictionless", preferred::near_frictionless(runs.by_default())),
        ("times-to-rest", runs.times_to_rest()),
        ("rest-over-time", endings::at_rest_over_time()),
        ("thesis-orbits", endings::thesis_orbits()),
        ("cycles", endings::cycles()),
        ("block-on-belt", endings::block_on_belt()),
        ("flips", runs.flips()),
        ("independent-program", counts::independent_program()),
    ] {
        compare(part, &format!("\n\n{table}\n"));
    }
    compare("newton", &runs.newton());
    compare("least-minor", &numbers::least_minor());
    runs.must_agree();
    runs.must_be_near_the_thesis();
}
