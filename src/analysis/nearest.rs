//! How near the balls come to rest to the stable equilibria that they would have without dry friction.
//!
//! The thesis remarks that preferred equilibria lie near these; here is how near, and how near positions
//! spread evenly over the equilibrium set would lie.

use std::sync::{Arc, Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::alike::groups_of_alike;
use super::balanced_family::distance_to_balance;
use super::frictionless::{FrictionlessKind, Place, frictionless_equilibria, places};
use super::linearised::{SmallMotions, Stability};
use super::rest_form::RestForm;
use super::set_samples::held_positions;
use super::torus_distance::torus_distance;
use crate::ending::{Label, Outcome};
use crate::model::{Case, Machine};

/// The viscous drag on the balls, over ball mass and natural frequency, with which stability is
/// judged: "arbitrarily high" in the thesis's words (section 5.1), so that `a1_plus` gives way to `b1`
/// at the natural frequency.
pub const HIGH_DRAG: f64 = 1e4;

/// The stable equilibrium without friction that is nearest to a position.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
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
    places: Vec<(FrictionlessKind, Rests)>,
}

#[derive(Clone, Debug, PartialEq)]
enum Rests {
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
                (0, _) => Rests::At(equilibrium.beta_rad?),
                (_, 3) => Rests::Balanced,
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
                Rests::At(other) => torus_distance(beta, other, &self.groups),
                Rests::Balanced => distance_to_balance(&self.form, beta)?,
            };
            Some(Nearest { kind: *kind, distance_rad })
        });
        all.min_by(|a, b| a.distance_rad.total_cmp(&b.distance_rad))
    }

    /// The median distance of positions spread evenly over the equilibrium set, rad: of the first 4096
    /// in it (256 for three balls and more) of 65,536 quasi-random ones, which makes it good to about 0.01 rad
    /// (0.05 rad). None where none of them is.
    pub fn median_of_even_spread(&self) -> Option<f64> {
        let balls = self.form.mass.len();
        let most = if balls > 2 { 256 } else { 4096 };
        let positions = held_positions(&self.form).take(most);
        let distances = positions.map(|beta| Some(self.nearest(beta)?.distance_rad));
        median(distances.collect::<Option<Vec<f64>>>()?)
    }
}

/// The value in the middle, or the mean of the two there; `None` of nothing.
fn median(mut values: Vec<f64>) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let (_, low, above) = values.select_nth_unstable_by(last / 2, f64::total_cmp);
    let high = if last % 2 == 0 { None } else { above.iter().copied().reduce(f64::min) };
    Some(high.map_or(*low, |high| *low + 0.5 * (high - *low)))
}

/// The same as [`StableEquilibria::nearest`], for a single position of a machine with up to three balls:
/// whether an equilibrium is stable is asked from the nearest on, until one is. (Of so few balls that is
/// always known. Of four that differ it may not be, and then nothing is said of any.)
fn nearest_of_one(machine: &Machine, beta: &[f64], groups: &[Vec<usize>]) -> Option<Nearest> {
    let form = RestForm::new(machine)?;
    if form.speed == 0.0 {
        return None;
    }
    let of_place = |place: Place| {
        let distance_rad = match place.family_dimension {
            0 => torus_distance(beta, &place.beta, groups),
            _ => distance_to_balance(&form, beta)?,
        };
        Some((distance_rad, place))
    };
    let mut all: Vec<(f64, Place)> = places(&form).into_iter().filter_map(of_place).collect();
    all.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    for (distance_rad, place) in all {
        let Place { kind, beta, family_dimension } = place;
        match SmallMotions::about(&form, &beta, HIGH_DRAG, family_dimension).stability {
            Stability::Stable => return Some(Nearest { kind, distance_rad }),
            Stability::Unknown => return None,
            Stability::Unstable | Stability::Marginal => {}
        }
    }
    None
}

/// Finds the nearest for one run after the other, keeping what is known of the last machine: one for
/// all runs of a point, unless its parameters are drawn. What it finds does not depend on that.
#[derive(Debug, Default)]
pub struct NearestFinder {
    drawn: bool,
    last: Mutex<Option<(Machine, Arc<Option<StableEquilibria>>)>>,
}

/// Most ways to lay balls on two sides of a line for which equilibria are computed run by run: those of
/// four balls that differ. More would take longer than the runs.
const MOST_WAYS: usize = 16;

impl NearestFinder {
    /// For a study in which parameters are `drawn` for each run, or are not.
    pub fn new(drawn: bool) -> Self {
        NearestFinder { drawn, ..Self::default() }
    }

    /// The stable equilibrium without friction that is nearest to where a run came to rest; none for
    /// runs that did not, for blocks, where [`StableEquilibria::of`] gives none, and for drawn machines
    /// with five balls or more that differ.
    pub fn nearest(&self, case: &Case, outcome: &Outcome) -> Option<Nearest> {
        if outcome.label() != Label::Equilibrium {
            return None;
        }
        let beta = outcome.position.as_ref()?;
        let machine = case.model.ball_balancer()?;
        if self.drawn {
            let groups = groups_of_alike(&machine.balls);
            let ways: usize = groups.iter().map(|group| group.len() + 1).product();
            return match (ways <= MOST_WAYS, beta.len()) {
                (true, ..=3) => nearest_of_one(machine, beta, &groups),
                (true, _) => StableEquilibria::of(machine)?.nearest(beta),
                (false, _) => None,
            };
        }
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

    use super::{HIGH_DRAG, NearestFinder, StableEquilibria, groups_of_alike, nearest_of_one};
    use crate::analysis::draws::Draws;
    use crate::analysis::{FrictionlessKind, Stability, frictionless_equilibria};
    use crate::ending::{Evidence, Outcome};
    use crate::model::{Ball, Case, Machine, Model, Simulation, Start};

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

    /// Many balls that are alike have eigenvalues that coincide; the stability of all is known still.
    #[test]
    fn stability_is_known_for_any_number_of_balls_that_are_alike() {
        for balls in 1..=8 {
            for (mass_kg, speed) in [1e-5, 5e-5, 1.4e-4]
                .into_iter()
                .flat_map(|mass| [-100.0, -160.0, -216.0, -300.0].map(|speed| (mass, speed)))
            {
                let machine = machine(speed, &vec![mass_kg; balls]);
                for equilibrium in frictionless_equilibria(&machine, HIGH_DRAG).unwrap() {
                    let known = equilibrium.stability != Stability::Unknown;
                    assert!(
                        known,
                        "{balls} balls of {mass_kg} kg at {speed}: {:?}",
                        equilibrium.kind
                    );
                }
            }
        }
    }

    /// Of random machines, at random places, the nearest found by itself is that of all.
    #[test]
    fn the_nearest_alone_is_the_nearest_of_all() {
        let mut draws = Draws::new(77);
        let mut found = [0; 2];
        for round in 0..600 {
            let balls = 1 + round % 3;
            let alike = draws.uniform() < 0.3;
            let masses: Vec<f64> = (0..balls)
                .map(|_| 1.4e-4 * if alike { 1.0 } else { 0.5 + draws.uniform() })
                .collect();
            // Every other one near the natural frequency, where nothing may be stable.
            let speeds = if round % 2 == 0 { [-120.0, -280.0] } else { [-179.0, -183.0] };
            let machine = machine(speeds[0] + (speeds[1] - speeds[0]) * draws.uniform(), &masses);
            let beta: Vec<f64> = (0..balls).map(|_| TAU * draws.uniform()).collect();
            let all = StableEquilibria::of(&machine).and_then(|all| all.nearest(&beta));
            let groups = groups_of_alike(&machine.balls);
            assert_eq!(nearest_of_one(&machine, &beta, &groups), all, "{machine:?} {beta:?}");
            found[usize::from(all.is_some())] += 1;
        }
        assert!(found.iter().all(|&count| count > 50), "{found:?}");
    }

    /// What has been kept of another machine changes nothing; machines that take long are left out
    /// where each run has its own.
    #[test]
    fn every_run_has_its_own_machine() {
        let at_rest = |balls: usize| Outcome {
            position: Some((0..balls).map(|ball| ball as f64 * 0.7).collect()),
            ..Outcome::failed(Evidence::RestCertified, String::new())
        };
        let case = |machine: &Machine| Case {
            model: Model::BallBalancer(machine.clone()),
            start: Start(Vec::new()),
            simulation: Simulation::default(),
        };
        let finder = NearestFinder::new(true);
        for speed in [-160.0, -216.0, -216.0, -160.0, -181.0, -160.0] {
            let machine = machine(speed, &[1.4e-4, 1.5e-4]);
            let outcome = at_rest(2);
            let alone = StableEquilibria::of(&machine)
                .and_then(|stable| stable.nearest(outcome.position.as_ref().unwrap()));
            assert_eq!(finder.nearest(&case(&machine), &outcome), alone);
            assert_eq!(alone.is_some(), speed != -181.0);
            let moving = Outcome { evidence: Evidence::EndTime, ..outcome };
            assert_eq!(finder.nearest(&case(&machine), &moving), None);
        }
        let alike = machine(-100.0, &[1e-5; 8]);
        let differ = machine(-100.0, &[1e-5, 1.1e-5, 1.2e-5, 1.3e-5, 1.4e-5]);
        for (machine, found) in [(alike, [true; 2]), (differ, [true, false])] {
            let outcome = at_rest(machine.balls.len());
            let nearest = [false, true]
                .map(|drawn| NearestFinder::new(drawn).nearest(&case(&machine), &outcome));
            assert_eq!(nearest.map(|one| one.is_some()), found);
        }
    }
}
