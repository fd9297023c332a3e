//! The equilibrium sets of a study, point by point (thesis figures 5.3 to 5.5).

use super::equilibrium_set::{angle_axis, set_layers};
use super::surface::surface;
use crate::analysis::set_fraction;
use crate::report::chart::{Figure, Panel};
use crate::report::gathered::{Budget, heading};
use crate::study::Study;

/// A panel for each point of the sweep, and for a single point also the surface of amplitude; none unless
/// there are two balls.
pub fn sets(study: &Study) -> Vec<Figure> {
    let count = study.point_count();
    let shown = count.min(Budget::SCREEN.details as u64);
    let mut facts = Vec::new();
    let mut panels = Vec::new();
    let mut surfaces = Vec::new();
    for point_id in 0..shown {
        let point = study.point(point_id);
        let Some(machine) = point.model().ball_balancer() else { continue };
        let Some(layers) = set_layers(machine) else { continue };
        let title = heading(study, &point.swept, |_| true);
        let share = set_fraction(machine).unwrap_or(f64::NAN);
        let name = if title.is_empty() { study.name() } else { &title };
        facts.push(format!("{name}: {:.1} % of all positions are equilibria", 100.0 * share));
        panels.push(Panel {
            title,
            part: String::new(),
            x: angle_axis(1),
            y: angle_axis(2),
            scale: Some(layers.scale),
            layers: layers.set.into_iter().chain(layers.frictionless).collect(),
        });
        if count == 1 {
            surfaces.extend(surface(machine));
        }
    }
    if panels.is_empty() {
        return Vec::new();
    }
    let left_out = match count > shown {
        true => format!(" Shown are the first {shown} of {count} points."),
        false => String::new(),
    };
    let set = Figure {
        id: "equilibrium-set".to_owned(),
        title: "Equilibrium set".to_owned(),
        caption: format!(
            "Where dry friction holds both balls. Colour: amplitude of the table; white: no equilibrium. \
             Stars and circles: stable and unstable equilibria without friction.{left_out}"
        ),
        alternative: facts.join("; ") + ".",
        one_at_a_time: panels.len() > 1,
        panels,
    };
    [set].into_iter().chain(surfaces).collect()
}
