//! `docs/convergence.csv`: errors against tolerance and band. `scripts/docs-pictures` draws them.

use std::fmt::Write;

use stickslip::model::Method;

use super::generated::compare_or_write;
use crate::classification::convergence::{Errors, errors};

/// One series of measurements over powers of ten.
struct Series {
    title: &'static str,
    abscissa: &'static str,
    powers: std::ops::RangeInclusive<i32>,
    errors: fn(f64) -> Errors,
}

const SERIES: [Series; 3] = [
    Series {
        title: "event method",
        abscissa: "relative tolerance per step",
        powers: 3..=12,
        errors: |tolerance| errors(Method::Event, tolerance, 1e-8),
    },
    Series {
        title: "switch model at band 1e-8",
        abscissa: "relative tolerance per step",
        powers: 3..=12,
        errors: |tolerance| errors(Method::Switch, tolerance, 1e-8),
    },
    Series {
        title: "switch model at tolerance 1e-12",
        abscissa: "half width of the band (non-dimensional)",
        powers: 2..=10,
        errors: |band| errors(Method::Switch, 1e-12, band),
    },
];

/// The numbers behind the assertions of `tests/classification/convergence.rs`.
#[test]
fn table_of_convergence() {
    let mut text =
        String::from("series,abscissa,value,time_of_rest,place_of_rest,period,amplitude\n");
    for Series { title, abscissa, powers, errors } in SERIES {
        for power in powers {
            let value = 10.0_f64.powi(-power);
            let Errors { rest_time, rest_position, period, amplitude } = errors(value);
            let [time, place, period, amplitude] = [rest_time, rest_position, period, amplitude]
                .map(|error| format!("{:.1e}", error.max(1e-14)));
            writeln!(text, "{title},{abscissa},1e-{power},{time},{place},{period},{amplitude}")
                .expect("writing into a string cannot fail");
        }
    }
    compare_or_write("docs/convergence.csv", &text);
}
