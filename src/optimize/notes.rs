//! Notes on a result that a reader should not miss: values on the bound of their range, and balls without use.

use super::finalists::Finalist;
use crate::analysis::Estimate;
use crate::study::{DesignValue, Study, Values, Variable};

/// Distance to a bound, as a fraction of the range, within which a value lies on the bound.
const ON_BOUND: f64 = 1e-3;
/// Mean amplitude, divided by that without balls, from which balls have almost no effect.
const ALMOST_NO_EFFECT: f64 = 0.95;

/// A bound of the range of a variable.
pub struct ReachedBound<'a> {
    /// The variable.
    pub variable: &'a Variable,
    /// `lower` or `upper`.
    pub which: &'static str,
    /// The range.
    pub range: [f64; 2],
}

/// Returns the bounds on which the values of a design lie.
pub fn on_bounds<'a>(study: &'a Study, values: &[DesignValue]) -> Vec<ReachedBound<'a>> {
    let bound = |(variable, value): (&'a Variable, &DesignValue)| {
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
        (!least).then_some(ReachedBound { variable, which, range })
    };
    study.variables().iter().zip(values).filter_map(bound).collect()
}

/// Returns what a reader should know about the best design, a sentence each.
pub fn notes(study: &Study, best: &Finalist) -> Vec<String> {
    let mut notes = bounds_in_words(study, &best.values);
    notes.extend(use_of_balls(&best.relative_amplitudes));
    notes
}

/// Returns a sentence for each value of a design that lies on a bound of its range.
fn bounds_in_words(study: &Study, values: &[DesignValue]) -> Vec<String> {
    let sentence = |ReachedBound { variable, which, range }: ReachedBound| {
        let (name, unit) = variable.name_and_unit();
        let [from, to] = range.map(|end| variable.describe(DesignValue::Number(end)));
        let range = format!("{from} to {to} {unit}");
        format!(
            "`{name}` lies on the {which} bound of its range ({}); a wider range may contain a better design.",
            range.trim_end()
        )
    };
    on_bounds(study, values).into_iter().map(sentence).collect()
}

/// Returns a sentence if the mean amplitudes at the points of the sweep, divided by those without balls, show that the
/// balls increase the amplitude at some point, or do not show that they decrease it.
fn use_of_balls(relative_amplitudes: &[Estimate]) -> Option<String> {
    let several = relative_amplitudes.len() > 1;
    let worst = |of: &dyn Fn(&Estimate) -> Option<f64>| {
        let known = relative_amplitudes.iter().filter_map(|ratio| Some((of(ratio)?, ratio)));
        known.max_by(|left, right| left.0.total_cmp(&right.0)).map(|(_, ratio)| ratio)
    };
    let increased =
        relative_amplitudes.iter().filter(|ratio| ratio.low.is_some_and(|low| low > 1.0));
    let increased = increased.count();
    if increased > 0 {
        let by =
            percents_above_one(worst(&|ratio| ratio.value.filter(|_| ratio.low > Some(1.0)))?)?;
        return Some(match several {
            false => format!(
                "The balls increase the mean amplitude by {by}: the machine is better without them."
            ),
            true => format!(
                "The balls increase the mean amplitude at {increased} of {} points of the sweep, by up to {by}: there \
                 the machine is better without them.",
                relative_amplitudes.len()
            ),
        });
    }
    let place = if several { " at some point of the sweep" } else { "" };
    let largest = worst(&|ratio| ratio.high.or(ratio.value))?;
    let value = largest.value?;
    if largest.high.unwrap_or(value) >= 1.0 {
        let interval = match (largest.low, largest.high) {
            (Some(low), Some(high)) => format!(" ({low:.3} to {high:.3})"),
            _ => String::new(),
        };
        return Some(format!(
            "The mean amplitude{place} cannot be distinguished from that of the same machine without balls: their ratio \
             is {value:.3}{interval}."
        ));
    }
    let closest = worst(&|ratio| ratio.value)?.value?;
    (closest >= ALMOST_NO_EFFECT).then(|| {
        format!(
            "The balls have almost no effect{place}: the mean amplitude is {} % of that of the same machine without \
             balls.",
            percent(closest)
        )
    })
}

/// Returns by how much an estimate exceeds one, such as `7.0 % (4.5 % to 9.6 %)`.
fn percents_above_one(estimate: &Estimate) -> Option<String> {
    let above = |value: f64| percent(value - 1.0);
    let value = above(estimate.value?);
    Some(match (estimate.low, estimate.high) {
        (Some(low), Some(high)) => format!("{value} % ({} to {} %)", above(low), above(high)),
        _ => format!("{value} %"),
    })
}

/// Returns a fraction as a number of percent, with two significant digits if it is small.
fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    if percent.abs() < 9.95 { format!("{percent:.1}") } else { format!("{percent:.0}") }
}

#[cfg(test)]
mod tests {
    use super::{on_bounds, use_of_balls};
    use crate::analysis::Estimate;
    use crate::optimize::space::study_with_four_variables;
    use crate::study::DesignValue;

    #[test]
    fn values_on_bounds() {
        let study = study_with_four_variables();
        let found = |speed: f64, balls: f64| {
            let numbers = [speed, balls, 900.0].map(DesignValue::Number);
            let mut values = numbers.to_vec();
            values.push(DesignValue::Choice(0));
            let bounds = on_bounds(&study, &values).into_iter();
            bounds
                .map(|bound| (bound.variable.name(), bound.which, bound.range))
                .collect::<Vec<_>>()
        };
        assert_eq!(found(-258.0, 2.0), []);
        let speed = |which| ("speed_rad_s", which, [-260.0, -140.0]);
        assert_eq!(found(-259.95, 1.0), [speed("lower")]);
        assert_eq!(found(-140.0, 3.0), [speed("upper"), ("balls", "upper", [1.0, 3.0])]);
    }

    #[test]
    fn balls_without_use() {
        let at = |value: f64, half: f64| {
            let ends = [Some(value - half), Some(value + half)];
            Estimate::with_interval(value, Some(0.01), ends, "none")
        };
        let said = |estimates: &[Estimate]| use_of_balls(estimates).expect("a note");
        assert_eq!(use_of_balls(&[at(0.5, 0.1), at(0.9, 0.04)]), None);
        assert_eq!(use_of_balls(&[Estimate::unknown("no balls")]), None);
        let almost = "The balls have almost no effect at some point of the sweep: the mean amplitude is 96 % of that of \
            the same machine without balls.";
        assert_eq!(said(&[at(0.5, 0.1), at(0.96, 0.02)]), almost);
        let unclear = "The mean amplitude cannot be distinguished from that of the same machine without balls: their \
            ratio is 0.980 (0.950 to 1.010).";
        assert_eq!(said(&[at(0.98, 0.03)]), unclear);
        let unclear = unclear.replace("amplitude", "amplitude at some point of the sweep");
        assert_eq!(said(&[at(0.5, 0.1), at(0.98, 0.03)]), unclear);
        let harm = "The balls increase the mean amplitude by 7.0 % (4.5 to 9.5 %): the machine is better without them.";
        assert_eq!(said(&[at(1.07, 0.025)]), harm);
        let harm = "The balls increase the mean amplitude at 2 of 3 points of the sweep, by up to 62 % (60 to 64 %): \
            there the machine is better without them.";
        assert_eq!(said(&[at(1.62, 0.02), at(1.3, 0.1), at(1.0, 2.0)]), harm);
    }
}
