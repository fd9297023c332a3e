//! Notes on a result that a reader should not miss: values on the bound of their range, and balls without use.

use super::finalists::Finalist;
use crate::responses::Estimate;
use crate::study::{DesignValue, Study, Values};

/// Distance to a bound, as a fraction of the range, within which a value lies on the bound.
const ON_BOUND: f64 = 1e-3;
/// Mean amplitude, divided by that without balls, from which balls have almost no effect.
const ALMOST_NO_EFFECT: f64 = 0.95;

/// A bound of the range of a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// Name of the variable.
    pub variable: String,
    /// `lower` or `upper`.
    pub which: &'static str,
    /// The range.
    pub range: [f64; 2],
}

/// Returns the bounds on which the values of a design lie.
pub fn on_bounds(study: &Study, values: &[DesignValue]) -> Vec<Bound> {
    let bound = |(variable, value): (&crate::study::Variable, &DesignValue)| {
        let range = match variable.values() {
            Values::Numbers(from, to) => [from, to],
            Values::Whole(from, to) => [from as f64, to as f64],
            Values::Choices(_) => return None,
        };
        let DesignValue::Number(number) = value else { return None };
        let [from, to] = range;
        let near = ON_BOUND * (to - from);
        let which = match () {
            () if from >= to => return None,
            () if number - from <= near => "lower",
            () if to - number <= near => "upper",
            () => return None,
        };
        // A machine has no fewer balls than one.
        let least = matches!(variable.values(), Values::Whole(1, _)) && which == "lower";
        (!least).then(|| Bound { variable: variable.name().to_owned(), which, range })
    };
    study.variables().iter().zip(values).filter_map(bound).collect()
}

/// Returns what a reader should know about the best design, a sentence each.
pub fn notes(study: &Study, best: &Finalist) -> Vec<String> {
    let on_bound = |bound: Bound| {
        let Bound { variable, which, range: [from, to] } = bound;
        format!(
            "`{variable}` lies on the {which} bound of its range ({from} to {to}); a wider range may contain a \
             better design"
        )
    };
    let mut notes: Vec<String> = on_bounds(study, &best.values).into_iter().map(on_bound).collect();
    notes.extend(use_of_balls(&best.relative_amplitudes).map(str::to_owned));
    notes
}

/// Returns a sentence if the mean amplitudes, divided by those without balls, show no use of the balls at some point.
fn use_of_balls(relative_amplitudes: &[Estimate]) -> Option<&'static str> {
    let reaches = |estimate: &Estimate| Some(estimate.high.unwrap_or(estimate.value?) >= 1.0);
    let almost = |estimate: &Estimate| Some(estimate.value? >= ALMOST_NO_EFFECT);
    let any = |of: &dyn Fn(&Estimate) -> Option<bool>| {
        relative_amplitudes.iter().filter_map(of).any(|one| one)
    };
    match () {
        () if any(&reaches) => Some(
            "the mean amplitude at some point of the sweep is not demonstrably below that of the same machine \
             without balls",
        ),
        () if any(&almost) => Some(
            "the balls have almost no effect at some point of the sweep: the mean amplitude is above 95 % of that of \
             the same machine without balls",
        ),
        () => None,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Bound, on_bounds, use_of_balls};
    use crate::responses::Estimate;
    use crate::study::{DesignValue, Study};

    #[test]
    fn values_on_bounds() {
        let text = "schema: 1\nname: one\nseed: 7\nmodel: {kind: ball_balancer}\n\
            initial_conditions: {design: {monte_carlo: {samples: 2}}}\n\
            design:\n  speed_rad_s: {from: -260, to: -160}\n  balls: {from: 1, to: 3}\n  \
            stiffness_n_m: {from: 900, to: 900}\n  \
            material: {choices: {a: {ball_mass_kg: 1e-4}, b: {ball_mass_kg: 2e-4}}}\n";
        let study = Study::parse(Path::new("a.yaml"), text.to_owned()).unwrap();
        let found = |speed: f64, balls: f64| {
            let numbers = [speed, balls, 900.0].map(DesignValue::Number);
            let mut values = numbers.to_vec();
            values.push(DesignValue::Choice(0));
            on_bounds(&study, &values)
        };
        assert_eq!(found(-259.0, 2.0), []);
        let range = [-260.0, -160.0];
        let speed = |which| Bound { variable: "speed_rad_s".to_owned(), which, range };
        let balls = Bound { variable: "balls".to_owned(), which: "upper", range: [1.0, 3.0] };
        assert_eq!(found(-259.95, 1.0), [speed("lower")]);
        assert_eq!(found(-160.0, 3.0), [speed("upper"), balls]);
    }

    #[test]
    fn balls_without_use() {
        let at = |value: f64, high: f64| {
            Estimate::with_interval(value, Some(0.01), [Some(value), Some(high)], "none")
        };
        assert_eq!(use_of_balls(&[at(0.5, 0.6), at(0.9, 0.94)]), None);
        assert!(use_of_balls(&[at(0.5, 0.6), at(0.96, 0.98)]).unwrap().contains("almost no"));
        assert!(
            use_of_balls(&[at(0.5, 0.6), at(0.98, 1.01)]).unwrap().contains("not demonstrably")
        );
        assert_eq!(use_of_balls(&[Estimate::unknown("no balls")]), None);
    }
}
