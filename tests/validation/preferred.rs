//! Distances of preferred equilibria from the equilibria without friction.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::fmt::Write;

use stickslip::analysis::{
    FrictionlessKind, HIGH_DRAG, Resolution, RestForm, Stability, Z_95, frictionless_equilibria,
    wilson,
};
use stickslip::classification::{Label, Outcome};
use stickslip::model::Machine;

use crate::docs::generated::compare_or_write_part;
use crate::support::angular_distance;

/// Returns the section, from the machines of the thesis's points and the outcomes of their runs.
pub fn near_frictionless<'a>(points: impl Iterator<Item = (&'a Machine, &'a [Outcome])>) -> String {
    let mut text = "\
| speed [rad/s] | μ | nearest | median distance [rad] | uniform [rad] | ratio | nearer | interval |
|---|---|---|---|---|---|---|---|
"
    .to_owned();
    let mut ratios = [f64::INFINITY, 0.0_f64];
    for (machine, outcomes) in points {
        let stable = stable_equilibria(machine);
        let chance = by_chance(machine, &stable);
        let at_rest = outcomes.iter().filter(|outcome| outcome.label() == Label::Equilibrium);
        let at_rest_nearest = at_rest.map(|outcome| {
            let beta = outcome.position.as_ref().expect("an equilibrium has angles");
            nearest(&stable, beta)
        });
        let mut kinds: BTreeMap<&str, u32> = BTreeMap::new();
        let mut distances = Vec::new();
        for (kind, distance) in at_rest_nearest {
            *kinds.entry(kind.name()).or_default() += 1;
            distances.push(distance);
        }
        distances.sort_by(f64::total_cmp);
        let all = distances.len();
        let median = 0.5 * (distances[(all - 1) / 2] + distances[all / 2]);
        ratios = [ratios[0].min(median / chance), ratios[1].max(median / chance)];
        let nearer = distances.partition_point(|distance| *distance < chance);
        let (low, high) = wilson(nearer as u64, all as u64, Z_95);
        let kinds: Vec<&str> = kinds.into_keys().collect();
        let _ = writeln!(
            text,
            "| {} | {:e} | {} | {median:.3} | {chance:.2} | {:.2} | {nearer} of {all} | {low:.4} .. \
             {high:.4} |",
            machine.speed_rad_s,
            machine.balls[0].friction_coefficient,
            kinds.join(", "),
            median / chance,
        );
    }
    let [least, most] = ratios.map(|ratio| format!("{ratio:.2}"));
    let range = format!("{least} to {most}");
    compare_or_write_part("docs/methods.md", "distance-ratios", &range);
    text
}

/// An equilibrium of two identical balls: its kind and their angles.
type Equilibrium = (FrictionlessKind, [f64; 2]);

/// Returns the equilibria without friction that are stable with a high drag.
fn stable_equilibria(machine: &Machine) -> Vec<Equilibrium> {
    let all = frictionless_equilibria(machine, HIGH_DRAG).expect("a machine with balls");
    let stable = all.into_iter().filter(|equilibrium| equilibrium.stability == Stability::Stable);
    let of = |equilibrium: stickslip::analysis::FrictionlessEquilibrium| {
        let beta = equilibrium.beta_rad.expect("isolated equilibria");
        (equilibrium.kind, beta.try_into().expect("two balls"))
    };
    stable.map(of).collect()
}

/// Returns the kind of the nearest stable equilibrium, and the root mean square of the angles to it,
/// in the better order of the balls.
fn nearest(stable: &[Equilibrium], beta: &[f64]) -> (FrictionlessKind, f64) {
    let away = |[a, b]: [f64; 2]| {
        angular_distance(beta[0], a).hypot(angular_distance(beta[1], b)) / 2.0_f64.sqrt()
    };
    let distances = stable.iter().map(|&(kind, [a, b])| (kind, away([a, b]).min(away([b, a]))));
    distances.min_by(|(_, a), (_, b)| a.total_cmp(b)).expect("a stable equilibrium")
}

/// Returns the median distance of all positions of a fine grid that are in the equilibrium set. It
/// is accurate to 0.001 rad (the grid of 2048 × 2048 differs by less), so that two printed digits
/// are right.
fn by_chance(machine: &Machine, stable: &[Equilibrium]) -> f64 {
    let form = RestForm::new(machine).expect("balls");
    let mut distances = Vec::new();
    let shown = Resolution::Grid(1024).visit(&form, |beta, rest| -> Result<(), Infallible> {
        if rest.in_set() {
            distances.push(nearest(stable, beta).1);
        }
        Ok(())
    });
    shown.expect("nothing is refused");
    distances.sort_by(f64::total_cmp);
    distances[distances.len() / 2]
}
