//! How near the balls come to rest to the stable equilibria that they would have without dry friction.
//!
//! The thesis remarks that preferred equilibria lie near these; here is how near, and how near positions
//! spread evenly over the equilibrium set would lie.

use std::sync::{Arc, Mutex, PoisonError};

use super::alike::groups_of_alike;
use super::balanced_family::distance_to_balance;
use super::frictionless::{FrictionlessKind, frictionless_equilibria};
use super::linearised::Stability;
use super::rest_form::RestForm;
use super::set_samples::{REPLICATES, sample};
use super::tally::Tally;
use super::torus_distance::torus_distance;
use crate::ending::{Label, Outcome};
use crate::model::{Case, Machine};

/// The viscous drag on the balls, over ball mass and natural frequency, with which stability is
/// judged: "arbitrarily high" in the thesis's words (section 5.1), so that `a1_plus` gives way to `b1`
/// at the natural frequency.
pub const HIGH_DRAG: f64 = 1e4;

/// The stable equilibrium without friction that is nearest to a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// What it looks like.
    pub kind: FrictionlessKind,
    /// How far it is: the root mean square over the balls of their angles to it, the least over
    /// exchanges of balls that are alike, rad; of a family, the distance to all of it.
    pub distance_rad: f64,
}

/// All stable equilibria without friction of a machine.
#[derive(Clone, Debug, PartialEq)]
pub struct StableEquilibria {
    form: RestForm,
    groups: Vec<Vec<usize>>,
    places: Vec<(FrictionlessKind, Place)>,
}

#[derive(Clone, Debug, PartialEq)]
enum Place {
    At(Vec<f64>),
    /// All balanced positions of three balls, stable where the one looked at is.
    Balanced,
}

impl StableEquilibria {
    /// Those of a machine. None where there are none; where the stability of one could not be
    /// computed; and of four balls and more where balanced positions are stable, a family to which
    /// no distance is computed.
    pub fn of(machine: &Machine) -> Option<Self> {
        let form = RestForm::new(machine)?;
        let mut places = Vec::new();
        for equilibrium in frictionless_equilibria(machine, HIGH_DRAG)? {
            match equilibrium.stability {
                Stability::Stable => {}
                Stability::Unknown => return None,
                Stability::Unstable | Stability::Marginal => continue,
            }
            let place = match (equilibrium.family_dimension, form.mass.len()) {
                (0, _) => Place::At(equilibrium.beta_rad?),
                (_, 3) => Place::Balanced,
                _ => return None,
            };
            places.push((equilibrium.kind, place));
        }
        let groups = groups_of_alike(&form.balls);
        (!places.is_empty()).then_some(StableEquilibria { form, groups, places })
    }

    /// The one that is nearest to balls at `beta`, one angle per ball, rad.
    pub fn nearest(&self, beta: &[f64]) -> Option<Nearest> {
        let all = self.places.iter().filter_map(|(kind, place)| {
            let distance_rad = match place {
                Place::At(other) => torus_distance(beta, other, &self.groups),
                Place::Balanced => distance_to_balance(&self.form, beta)?,
            };
            Some(Nearest { kind: *kind, distance_rad })
        });
        all.min_by(|a, b| a.distance_rad.total_cmp(&b.distance_rad))
    }

    /// The median distance of positions spread evenly over the equilibrium set, rad: of the first 4096
    /// in it (256 for three balls and more) of 65,536 quasi-random ones. None where none of them is.
    pub fn median_of_even_spread(&self) -> Option<f64> {
        let balls = self.form.mass.len();
        let most = if balls > 2 { 256 } else { 4096 };
        let positions = (0..1 << 12).flat_map(|index| {
            (0..REPLICATES).map(move |replicate| sample(balls, replicate, index))
        });
        let mut distances = Tally::default();
        for beta in positions.filter(|beta| self.form.at_rest(beta).in_set()).take(most) {
            distances.add(self.nearest(&beta)?.distance_rad, 0);
        }
        distances.quantile(0.5)
    }
}

/// Finds the nearest for one run after the other, keeping what is known of the last machine: one for
/// all runs of a point, unless its parameters are drawn. What it finds does not depend on that.
#[derive(Debug, Default)]
pub struct NearestFinder {
    last: Mutex<Option<(Machine, Arc<Option<StableEquilibria>>)>>,
}

impl NearestFinder {
    /// The stable equilibrium without friction that is nearest to where a run came to rest; none for
    /// runs that did not, for blocks, and where [`StableEquilibria::of`] gives none.
    pub fn nearest(&self, case: &Case, outcome: &Outcome) -> Option<Nearest> {
        if outcome.label() != Label::Equilibrium {
            return None;
        }
        let beta = outcome.position.as_ref()?;
        let machine = case.model.ball_balancer()?;
        self.of(machine).as_ref().as_ref()?.nearest(beta)
    }

    fn of(&self, machine: &Machine) -> Arc<Option<StableEquilibria>> {
        // What is kept is whole, whatever thread has failed.
        let known = |last: &Option<(Machine, Arc<Option<StableEquilibria>>)>| {
            last.as_ref().filter(|(other, _)| other == machine).map(|(_, stable)| stable.clone())
        };
        if let Some(stable) = known(&self.last.lock().unwrap_or_else(PoisonError::into_inner)) {
            return stable;
        }
        let stable = Arc::new(StableEquilibria::of(machine));
        let kept = Some((machine.clone(), stable.clone()));
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = kept;
        stable
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::StableEquilibria;
    use crate::analysis::FrictionlessKind;
    use crate::analysis::draws::Draws;
    use crate::model::{Ball, Machine};

    fn machine(speed_rad_s: f64, masses_kg: &[f64]) -> Machine {
        let ball = |&mass_kg: &f64| Ball { mass_kg, ..Ball::default() };
        Machine { speed_rad_s, balls: masses_kg.iter().map(ball).collect(), ..Machine::default() }
    }

    /// Below the natural frequency both balls together, above it balanced, between about 179.3 and
    /// 181.6 rad/s nothing (thesis figure 5.1); the balancing angles are 2.270 and 4.013 rad.
    #[test]
    fn the_thesis_machine() {
        let two = [1.4e-4; 2];
        let stable = StableEquilibria::of(&machine(-160.0, &two)).unwrap();
        let nearest = stable.nearest(&[0.3, 6.0]).unwrap();
        assert_eq!((nearest.kind, stable.places.len()), (FrictionlessKind::A1Plus, 1));
        assert_eq!(StableEquilibria::of(&machine(-181.0, &two)), None);
        assert_eq!(StableEquilibria::of(&machine(0.0, &two)), None);
        let stable = StableEquilibria::of(&machine(-216.0, &two)).unwrap();
        let nearest = stable.nearest(&[4.013 - 0.1, 2.270 + 0.1]).unwrap();
        assert_eq!(nearest.kind, FrictionlessKind::B1);
        assert!((nearest.distance_rad - 0.1).abs() < 1e-3);
    }

    /// Balls that differ keep their names: both balanced positions are equilibria of their own. Four
    /// balls balance in a family that is not searched.
    #[test]
    fn other_balls() {
        let differ = StableEquilibria::of(&machine(-216.0, &[1.4e-4, 1.5e-4])).unwrap();
        assert_eq!(differ.places.len(), 2);
        let three = StableEquilibria::of(&machine(-216.0, &[1.4e-4; 3])).unwrap();
        let kinds: Vec<FrictionlessKind> = three.places.iter().map(|(kind, _)| *kind).collect();
        assert_eq!(kinds, [FrictionlessKind::B1]);
        assert!(three.nearest(&[0.1, 1.0, 2.0]).is_some());
        assert_eq!(StableEquilibria::of(&machine(-216.0, &[1.4e-4; 4])), None);
        assert!(StableEquilibria::of(&machine(-120.0, &[1.4e-4; 4])).is_some());
    }

    /// The median over the set against that of plain random positions. Were the positions of the former
    /// random, too, 256 of them would have it between the 0.37 and 0.63 quantiles of 1000 others but
    /// for a probability of 2e-4 (3.7 standard deviations of both).
    #[test]
    fn even_spread_is_that_of_random_positions() {
        let mut draws = Draws::new(4);
        for machine in [machine(-160.0, &[1.4e-4; 2]), machine(-216.0, &[1.4e-4; 3])] {
            let stable = StableEquilibria::of(&machine).unwrap();
            let mut distances = Vec::new();
            while distances.len() < 1000 {
                let beta: Vec<f64> =
                    (0..machine.balls.len()).map(|_| TAU * draws.uniform()).collect();
                if stable.form.at_rest(&beta).in_set() {
                    distances.push(stable.nearest(&beta).unwrap().distance_rad);
                }
            }
            distances.sort_by(f64::total_cmp);
            let found = stable.median_of_even_spread().unwrap();
            assert!(distances[370] < found && found < distances[630], "{found}");
        }
    }
}
