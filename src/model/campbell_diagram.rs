//! How the natural frequencies of a model change with the speed of a part that turns (Campbell diagram).

use super::Model;
use super::natural_frequencies::frequencies;

/// Natural frequencies over the speed of a part that turns, and the speeds that equal one of them.
#[derive(Clone, Debug, PartialEq)]
pub struct CampbellDiagram {
    /// The speeds, without their sign, in ascending order, rad/s.
    pub speeds_rad_s: Vec<f64>,
    /// The natural frequencies at each speed, in ascending order, rad/s.
    pub frequencies_rad_s: Vec<Vec<f64>>,
    /// The critical speeds, which equal a natural frequency, in ascending order, rad/s. Coordinates are those of a frame that does
    /// not turn; on equal supports, an imbalance excites forward whirl only.
    pub critical_rad_s: Vec<f64>,
}

/// The number of intervals of speeds.
const INTERVALS: usize = 96;

/// The number of halvings of the interval with a critical speed.
const HALVINGS: usize = 40;

/// How much a matrix may differ from a polynomial of second degree in the speed, over its size.
const ROUNDING: f64 = 1e-6;

impl CampbellDiagram {
    /// Computes the diagram from standstill up to a fourth more than the speed of the model and its highest natural frequency there.
    /// `None` for a ball balancer, for a model without a part that turns or without natural frequencies, and for equations of small
    /// motions that are not polynomials of second degree in the speed.
    pub fn of(model: &Model) -> Option<Self> {
        let Model::Own(own_model) = model else { return None };
        let speed = model.speed_parameter()?;
        let own_speed = own_model.number(speed.name);
        let computed = |speed_rad_s: f64| {
            let mut changed = own_model.clone();
            *changed.number_mut(speed)? = own_speed.signum() * speed_rad_s;
            let equations = changed.own_kind.small_motions(&changed);
            equations.held.or(equations.free)
        };
        let at_own = computed(own_speed.abs())?;
        let highest = *frequencies(at_own.clone())?.last()?;
        let most = 1.25 * highest.max(own_speed.abs());
        // Gyroscopic terms contain the speed, and terms of a frame that turns contain its square.
        let [a, b, c] = [0.25 * most, 0.6 * most, most];
        let [of_a, of_b, of_c] = [computed(a)?, computed(b)?, computed(c)?];
        let matrix = |s: f64| {
            let weight = |node: f64, [left, right]: [f64; 2]| {
                (s - left) * (s - right) / ((node - left) * (node - right))
            };
            &of_a * weight(a, [b, c]) + &of_b * weight(b, [a, c]) + &of_c * weight(c, [a, b])
        };
        if (matrix(own_speed.abs()) - &at_own).norm() > ROUNDING * at_own.norm() {
            return None;
        }
        let at = |speed_rad_s: f64| frequencies(matrix(speed_rad_s));
        let speeds_rad_s: Vec<f64> =
            (0..=INTERVALS).map(|place| most * place as f64 / INTERVALS as f64).collect();
        let frequencies_rad_s: Option<Vec<_>> =
            speeds_rad_s.iter().map(|speed| at(*speed)).collect();
        let frequencies_rad_s = frequencies_rad_s?;
        // A natural frequency above the speed at one end of an interval and below it at the other equals it between them.
        let mut critical_rad_s = Vec::new();
        for (ends, pair) in speeds_rad_s.windows(2).zip(frequencies_rad_s.windows(2)) {
            let of_all = pair[0].iter().zip(&pair[1]).enumerate();
            for (which, (at_low, at_high)) in of_all.filter(|_| pair[0].len() == pair[1].len()) {
                let [mut low, mut high] = [ends[0], ends[1]];
                let is_above = *at_low > low;
                if is_above == (*at_high > high) {
                    continue;
                }
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    match (*at(middle)?.get(which)? > middle) == is_above {
                        true => low = middle,
                        false => high = middle,
                    }
                }
                critical_rad_s.push(0.5 * (low + high));
            }
        }
        critical_rad_s.sort_by(f64::total_cmp);
        Some(CampbellDiagram { speeds_rad_s, frequencies_rad_s, critical_rad_s })
    }
}
