//! Values of one machine that are possible but unlikely: balls without room, densities of no material, lengths, suspensions,
//! friction and speeds out of any range, balls that cannot balance, a ring that is more eccentric than the table vibrates, and
//! impacts without loss.

use std::f64::consts::TAU;

use super::ball_fit::{BallPositions, density_kg_m3, occupied_angle};
use super::facts::capacity_kg_m;
use super::unit_mistakes::{HEAVY_BALLS, UsualLimit, has_mass_of_template, limits};
use super::warning::Finding;
use crate::analysis::{Balance, RestForm, reference_amplitude};
use crate::model::{
    Ball, DerivedQuantity, FrictionLaw, LawDimension, LawParameter, Machine, Model,
    ParameterDescriptor, STEEL_KG_M3,
};
use crate::numbers::short;
use crate::study::{ListedParameter, Study};

/// Densities of solid balls, from light plastics to tungsten and platinum, kg/m³.
const DENSITIES_KG_M3: [f64; 2] = [500.0, 25_000.0];
/// Friction coefficients other than 0.
const FRICTION: [f64; 2] = [1e-6, 2.0];
/// The fastest disc, rad/s; 1e5 rad/s are 955,000 revolutions per minute.
const FASTEST_RAD_S: f64 = 1e5;
/// The fastest part of a machine, m/s.
const FASTEST_M_S: f64 = 1e3;
/// The fraction of the positions of rest above which overlapping balls are a warning.
const MOST_OVERLAPPING: f64 = 0.5;

/// Returns the findings about the values of a model at a point. `positions` are those of its number of balls.
pub(super) fn findings(
    study: &Study,
    point_id: u64,
    model: &Model,
    positions: Option<&BallPositions>,
) -> Vec<Finding> {
    let at = FindingPoint { study, point_id };
    let Some(machine) = model.ball_balancer() else {
        let kinetic = model.friction_coefficient();
        let friction = kinetic.and_then(|kinetic| at.friction(model.friction(), kinetic, None));
        let profile = at.profile(model);
        let all = friction.into_iter().chain(at.fast_support(model)).chain(profile);
        let all = all.chain(at.motions(model));
        return all.chain(at.unusual(model)).collect();
    };
    let fits = [at.ring(machine), at.room(machine)].into_iter().flatten();
    let mut all: Vec<Finding> = fits.collect();
    let has_room = all.is_empty();
    let balls = || machine.balls.iter().zip(1..);
    let density = balls().find_map(|(ball, number)| at.density(ball, number));
    let is_dense = density.is_some();
    all.extend(density);
    all.extend(balls().find_map(|(ball, number)| {
        at.friction(&machine.friction, ball.friction_coefficient, Some(number))
    }));
    all.extend(at.speed(machine));
    all.extend(at.profile(model));
    // A density of no material explains heavy balls.
    let limits = limits(machine, |name, value| at.said(name, value)).into_iter();
    let limits = limits.filter(|limit| !(is_dense && limit.kind == HEAVY_BALLS));
    all.extend(limits.filter_map(|limit| at.limit(limit)));
    all.extend(at.balance(machine));
    all.extend(at.runout(machine));
    all.extend(at.elastic_contact(machine));
    if let Some(positions) = positions.filter(|_| has_room) {
        all.extend(at.overlap(machine, positions));
    }
    all
}

/// Returns whether the balls have room in the ring.
pub(super) fn has_room(machine: &Machine) -> bool {
    machine.balls.iter().all(|ball| 0.5 * ball.diameter_m < machine.ring_radius_m)
        && occupied_angle(machine) <= TAU
}

/// The point of the sweep that the findings concern.
struct FindingPoint<'a> {
    study: &'a Study,
    point_id: u64,
}

impl FindingPoint<'_> {
    fn key(&self, name: &str, ball: Option<usize>) -> String {
        self.study.key_of(name, ball, self.point_id)
    }

    /// Returns the name of a parameter as the study writes it: without its unit if the value has one.
    fn name<'a>(&self, name: &'a str) -> &'a str {
        let is_with_unit = [None, Some(1)]
            .iter()
            .any(|ball| self.study.key_with_unit(&self.key(name, *ball)).is_some());
        let endings = ["_rad_s", "_kg", "_m"];
        let short = endings.iter().find_map(|ending| name.strip_suffix(ending));
        short.filter(|_| is_with_unit).unwrap_or(name)
    }

    /// Returns the value of a parameter with the unit in which the study shows it.
    fn said(&self, name: &str, value: f64) -> String {
        let unit = self.study.units().shown(name);
        format!("{} {}", short(unit.of(value)), unit.symbol)
    }

    /// Returns a remark on the unit of a number, unless the study writes the unit of this key itself.
    fn remark(&self, key: &str, remark: &'static str) -> &'static str {
        if self.study.key_with_unit(key).is_some() { "" } else { remark }
    }

    /// Returns the derived quantities of a system that are outside of their usual ranges.
    fn unusual(&self, model: &Model) -> Vec<Finding> {
        let Model::Own(own_model) = model else { return Vec::new() };
        let finding = |derived: DerivedQuantity| {
            let DerivedQuantity { name, value, usual, .. } = derived;
            let [low, high] = usual.filter(|[low, high]| !(*low..=*high).contains(&value))?;
            Some(Finding {
                kind: "unusual_machine",
                key: format!("model.{}", name.name),
                problem: format!("a quantity is outside of its usual range: {}", name.meaning),
                found: self.said(&name.name, value).trim_end().to_owned(),
                remedy: format!(
                    "parameters with which it is from {} to {}",
                    self.said(&name.name, low).trim_end(),
                    self.said(&name.name, high).trim_end()
                ),
            })
        };
        own_model.derived().into_iter().filter_map(finding).collect()
    }

    fn ring(&self, machine: &Machine) -> Option<Finding> {
        let radius_m = machine.ring_radius_m;
        let too_big = |ball: &Ball| 0.5 * ball.diameter_m >= radius_m;
        let index = machine.balls.iter().position(too_big)?;
        let diameter_m = machine.balls.get(index)?.diameter_m;
        let key = self.key("ball_diameter_m", Some(index + 1));
        Some(Finding {
            kind: "ball_beyond_ring",
            problem: "a ball reaches the centre of the ring".to_owned(),
            found: format!(
                "a ball diameter of {}, while the centres of the balls are {} from the centre of the ring",
                self.said("ball_diameter_m", diameter_m),
                self.said("ring_radius_m", radius_m)
            ),
            remedy: format!(
                "{} below twice {}{}",
                self.name("ball_diameter_m"),
                self.name("ring_radius_m"),
                self.remark(&key, "; lengths are in m, not in mm")
            ),
            key,
        })
    }

    fn room(&self, machine: &Machine) -> Option<Finding> {
        let occupied = occupied_angle(machine);
        let balls = machine.balls.len();
        if occupied <= TAU || self.ring(machine).is_some() {
            return None;
        }
        let most = (TAU / occupied * balls as f64).floor();
        Some(Finding {
            kind: "balls_do_not_fit",
            key: self.key("ball_diameter_m", Some(1)),
            problem: "the balls do not fit side by side into the ring".to_owned(),
            found: format!(
                "{balls} balls of {} in a ring of radius {} occupy {:.0}° of 360°",
                self.said("ball_diameter_m", machine.balls.first()?.diameter_m),
                self.said("ring_radius_m", machine.ring_radius_m),
                occupied.to_degrees()
            ),
            remedy: format!(
                "at most {most:.0} such balls, smaller balls, or a larger {}",
                self.name("ring_radius_m")
            ),
        })
    }

    fn density(&self, ball: &Ball, number: usize) -> Option<Finding> {
        let density = density_kg_m3(ball);
        let [least, most] = DENSITIES_KG_M3;
        let listed = self.study.parameters();
        let of = |name: &'static str| listed.iter().filter(move |parameter| parameter.name == name);
        let is_varied = |name| of(name).any(ListedParameter::is_varied);
        let (problem, allowed) = if !(least..=most).contains(&density) {
            ("no material has the density of the balls", format!("{least} to {most} kg/m³"))
        } else if !is_varied("ball_mass_kg") && has_mass_of_template(ball) {
            let problem = "the balls have the mass of the default machine or of a template, but not its diameter";
            (problem, "the mass of a ball of this diameter".to_owned())
        } else {
            return None;
        };
        let steel_kg = STEEL_KG_M3 * ball.volume_m3();
        let mass = self.key("ball_mass_kg", Some(number));
        let diameter = self.key("ball_diameter_m", Some(number));
        let is_default = of("ball_mass_kg").any(|parameter| parameter.is_default);
        let is_of_diameter = is_default || is_varied("ball_diameter_m");
        let units = match [&mass, &diameter].map(|key| self.study.key_with_unit(key).is_some()) {
            [true, true] => "",
            _ => ", with the mass in kg and the diameter in m",
        };
        let key = if is_of_diameter && !is_varied("ball_mass_kg") { diameter } else { mass };
        Some(Finding {
            kind: "ball_density",
            key,
            problem: problem.to_owned(),
            found: format!(
                "a ball of {} with a diameter of {}, which is {} kg/m³",
                self.said("ball_mass_kg", ball.mass_kg),
                self.said("ball_diameter_m", ball.diameter_m),
                short(density)
            ),
            remedy: format!(
                "{allowed}{units}; a steel ball of this diameter has {} kg",
                short(steel_kg)
            ),
        })
    }

    fn friction(&self, law: &FrictionLaw, kinetic: f64, ball: Option<usize>) -> Option<Finding> {
        let [least, most] = FRICTION;
        let unlikely = |value: f64| value > most || (value > 0.0 && value < least);
        if !law.law().uses_friction_coefficient() {
            return None;
        }
        let unlikely_ratio = |parameter: &&LawParameter| {
            let value = law.value(parameter.name);
            parameter.dimension == LawDimension::Ratio && value.is_some_and(unlikely)
        };
        let of_law = law.law().parameters().iter().find(unlikely_ratio);
        let (name, ball, value) = match of_law {
            Some(parameter) => (parameter.name, None, law.value(parameter.name)?),
            None if unlikely(kinetic) => ("friction_coefficient", ball, kinetic),
            None => return None,
        };
        let usual = if ball.is_some() {
            "about 1e-4 to 1e-2 for a hard ball that rolls"
        } else {
            "about 0.05 to 1 for dry sliding"
        };
        Some(Finding {
            kind: "friction_coefficient",
            key: self.key(name, ball),
            problem: "an unusual friction coefficient".to_owned(),
            found: short(value),
            remedy: format!("0, or a value from {least:e} to {most}; {usual}"),
        })
    }

    fn speed(&self, machine: &Machine) -> Option<Finding> {
        let speed = machine.speed_rad_s;
        let key = self.key("speed_rad_s", None);
        (speed.abs() > FASTEST_RAD_S).then(|| Finding {
            kind: "speed",
            problem: "a speed that no disc reaches".to_owned(),
            found: format!("{} rad/s, which is {:.0} rpm", short(speed), speed.abs() * 60.0 / TAU),
            remedy: format!("at most {FASTEST_RAD_S:e} rad/s{}", self.remark(&key, RPM)),
            key,
        })
    }

    fn profile(&self, model: &Model) -> Option<Finding> {
        let [_, end_s] = self.study.simulation().end_times_s();
        let disc = model.disc_motion()?;
        let (last, _) = disc.segments.last()?;
        // A profile that ends with a plateau sets the end time itself.
        let has_end = model.speed_profile()?.end_time_s().is_some();
        let keys = ["simulation.end_time_s", "model.speed_profile", "model.protocol"];
        (!has_end && end_s <= last.begins_s).then(|| Finding {
            kind: "profile_beyond_end",
            key: keys.into_iter().find(|key| self.study.has_key(key)).unwrap_or("model").to_owned(),
            problem: "runs end within the speed profile, and no run reaches the last speed"
                .to_owned(),
            found: format!(
                "an end at {} s with {} rad/s; the profile reaches {} rad/s at {} s",
                short(end_s),
                short(disc.speed_rad_s(end_s)),
                short(last.terms[0]),
                short(last.begins_s)
            ),
            remedy: "a larger simulation.end_time_s, with time to come to rest at the last speed"
                .to_owned(),
        })
    }

    /// Finds runs that end before the last row of a motion.
    fn motions(&self, model: &Model) -> Option<Finding> {
        let end_s = model.end_time_s().unwrap_or(self.study.simulation().end_time_s);
        let ends = model.given_motions().into_iter().filter_map(|motion| motion.times_s().last());
        let begins_s = ends.fold(0.0, f64::max);
        (end_s < begins_s).then(|| Finding {
            kind: "motion_beyond_end",
            key: "simulation.end_time_s".to_owned(),
            problem: "runs end within a motion of a table".to_owned(),
            found: format!(
                "an end at {} s; the motion ends at {} s",
                short(end_s),
                short(begins_s)
            ),
            remedy: "a larger simulation.end_time_s, with time to come to rest after the motion"
                .to_owned(),
        })
    }

    fn limit(&self, limit: UsualLimit) -> Option<Finding> {
        let listed = self.study.parameters();
        let is_given =
            |name: &&&str| listed.iter().any(|entry| entry.name == **name && !entry.is_default);
        let name = limit.parameters.iter().find(is_given).or(limit.parameters.first())?;
        let key = self.key(name, None);
        limit.is_exceeded.then(|| Finding {
            kind: limit.kind,
            problem: limit.problem.to_owned(),
            found: limit.found,
            remedy: format!("{}{}", limit.remedy, self.remark(&key, limit.remark)),
            key,
        })
    }

    /// Speeds of a system without balls, such as that of a belt.
    fn fast_support(&self, model: &Model) -> Option<Finding> {
        let speed = |parameter: &ParameterDescriptor| {
            parameter.numbers(&mut model.clone(), None).first().map_or(0.0, |speed| speed.abs())
        };
        let mut parameters = model.kind().parameters.iter();
        let fast = parameters.find(|entry| entry.unit == "m/s" && speed(entry) > FASTEST_M_S)?;
        Some(Finding {
            kind: "speed",
            key: self.key(fast.name, None),
            problem: "a speed that no machine reaches".to_owned(),
            found: format!("{} m/s", short(speed(fast))),
            remedy: format!("at most {FASTEST_M_S} m/s"),
        })
    }

    fn balance(&self, machine: &Machine) -> Option<Finding> {
        let form = RestForm::new(machine)?;
        if Balance::of(&form) != Balance::Nowhere {
            return None;
        }
        let unit = self.study.units().imbalance();
        let capacity = capacity_kg_m(machine);
        // With a runout of the ring, the imbalance that the balls feel.
        let given = machine.imbalance_mass_kg * machine.imbalance_radius_m;
        let felt = form.imbalance.norm() * machine.total_mass_kg() * machine.ring_radius_m;
        let has_runout = machine.ring_runout_m != 0.0;
        let imbalance = if has_runout { felt } else { given };
        let (problem, remedy) = if capacity < imbalance {
            let remedy =
                format!("more or heavier balls, or a larger {}", self.name("ring_radius_m"));
            ("the balls cannot balance the imbalance: they are too light", remedy)
        } else {
            let remedy = "two or more balls, where no ball outweighs the other balls and the imbalance together"
                .to_owned();
            ("the balls cannot balance the imbalance: one ball is too heavy", remedy)
        };
        Some(Finding {
            kind: "balancing_capacity",
            key: self.key("ball_mass_kg", None),
            problem: problem.to_owned(),
            found: format!(
                "ball masses times {} are {} {symbol}, and the imbalance{} is {} {symbol}",
                self.name("ring_radius_m"),
                short(unit.of(capacity)),
                if has_runout { " with the runout of the ring" } else { "" },
                short(unit.of(imbalance)),
                symbol = unit.symbol
            ),
            remedy,
        })
    }

    fn runout(&self, machine: &Machine) -> Option<Finding> {
        let runout_m = machine.ring_runout_m;
        let without_balls_m = reference_amplitude(machine)?;
        (runout_m > without_balls_m && without_balls_m > 0.0).then(|| Finding {
            kind: "ring_runout",
            key: self.key("ring_runout_m", None),
            problem: "the balls cannot reduce the vibration: free balls bring the centre of the ring to the axis, \
                      and the table then vibrates with the runout as its amplitude"
                .to_owned(),
            found: format!(
                "a runout of {}, and an amplitude without balls of {}",
                self.said("ring_runout_m", runout_m),
                self.said("ring_runout_m", without_balls_m)
            ),
            remedy: format!(
                "{} below the amplitude without balls{}",
                self.name("ring_runout_m"),
                self.remark("ring_runout_m", "; lengths are in m, not in mm")
            ),
        })
    }

    fn elastic_contact(&self, machine: &Machine) -> Option<Finding> {
        let contact = machine.contact.filter(|_| machine.balls.len() > 1)?;
        let key = self.key("contact_restitution", None);
        let is_of_law = key.starts_with("model.");
        (contact.restitution == 1.0).then(|| Finding {
            kind: "elastic_contact",
            key: if is_of_law { "model.contact.restitution".to_owned() } else { key },
            problem: "impacts do not end in lasting contact, so that balls that a force presses together bounce \
                      without end, and their runs are slow or fail with step_limit"
                .to_owned(),
            found: "a restitution of 1".to_owned(),
            remedy: "a restitution below 1, such as 0.99".to_owned(),
        })
    }

    fn overlap(&self, machine: &Machine, positions: &BallPositions) -> Option<Finding> {
        if !machine.friction.can_stick() {
            return None;
        }
        let fraction = positions.overlapping_fraction(machine)?;
        (fraction > MOST_OVERLAPPING).then(|| Finding {
            kind: "overlapping_rests",
            key: self.key("ball_diameter_m", Some(1)),
            problem: "balls overlap in most positions of rest, because the study has no contact between balls"
                .to_owned(),
            found: format!("{:.0} % of the positions of rest", 100.0 * fraction),
            remedy: "model.contact, which keeps balls apart, or fewer or smaller balls".to_owned(),
        })
    }
}

/// A remark for a study that writes speeds in rad/s.
pub(super) const RPM: &str = "; 1 rpm is 0.10472 rad/s";
