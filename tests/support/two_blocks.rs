//! Two coupled blocks on a belt in closed form: in each phase, the motion is a sum of harmonic oscillations.

/// Two blocks without dimensions, each sticking (0) or slipping in a direction (1 or -1).
///
/// `ẍ_i = -x_i + κ (x_j - x_i) - f_i` with the normal force 1. If both slip, sum and difference of the positions oscillate
/// with the frequencies 1 and `sqrt(1 + 2κ)`; if one sticks to the belt, the other oscillates with `sqrt(1 + κ)` about a place
/// that moves at constant speed.
pub struct TwoBlocks {
    pub coupling: f64,
    pub belt_speed: f64,
    pub kinetic_coefficient: f64,
    pub static_coefficient: f64,
    /// The time, the positions and the velocities at the last switch, and the phases since then.
    pub since: f64,
    pub x: [f64; 2],
    pub u: [f64; 2],
    pub phases: [f64; 2],
}

impl TwoBlocks {
    /// Returns positions and velocities at a time since the last switch.
    pub fn at(&self, t: f64) -> ([f64; 2], [f64; 2]) {
        let Self { coupling: k, belt_speed: v, x, u, phases, .. } = self;
        let force = phases.map(|direction| -self.kinetic_coefficient * direction);
        // Displacement and velocity of an oscillator about a place that moves with the speed `along`.
        let oscillator = |w: f64, place: f64, along: f64, x: f64, u: f64| {
            let (a, b, (sine, cosine)) = (x - place, (u - along) / w, (w * t).sin_cos());
            let velocity = along + w * (b * cosine - a * sine);
            (place + along * t + a * cosine + b * sine, velocity)
        };
        if phases[0] != 0.0 && phases[1] != 0.0 {
            let modes = [(1.0, 1.0), (1.0 + 2.0 * k, -1.0)].map(|(square, sign): (f64, f64)| {
                let of = |pair: [f64; 2]| 0.5 * (pair[0] + sign * pair[1]);
                oscillator(square.sqrt(), of(force) / square, 0.0, of(*x), of(*u))
            });
            let [(sum, sum_u), (difference, difference_u)] = modes;
            return (
                [sum + difference, sum - difference],
                [sum_u + difference_u, sum_u - difference_u],
            );
        }
        let (mut positions, mut velocities) = ([0.0; 2], [0.0; 2]);
        for i in 0..2 {
            let square = 1.0 + k;
            let place = (k * x[1 - i] + force[i]) / square;
            (positions[i], velocities[i]) = match phases[i] {
                0.0 => (x[i] + v * t, *v),
                _ => oscillator(square.sqrt(), place, k * v / square, x[i], u[i]),
            };
        }
        (positions, velocities)
    }

    fn springs(&self, x: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| -x[i] + self.coupling * (x[1 - i] - x[i]))
    }

    /// Returns what is negative once a block has left its phase.
    fn reserve(&self, block: usize, t: f64) -> f64 {
        let (x, u) = self.at(t);
        match self.phases[block] {
            0.0 => self.static_coefficient - self.springs(x)[block].abs(),
            direction => direction * (u[block] - self.belt_speed),
        }
    }

    /// Continues to the next switch before a time. Returns its block.
    pub fn next_switch(&mut self, end: f64) -> Option<usize> {
        let (step, rest) = (1e-3, end - self.since);
        let steps = 1..=(rest / step).ceil() as u64;
        let first = steps.map(|number| (number as f64 * step).min(rest));
        let left = |t: f64| [0, 1].map(|block| self.reserve(block, t) < 0.0);
        let after = first.into_iter().find(|&t| left(t).contains(&true))?;
        let blocks = [0, 1].into_iter().filter(|&block| left(after)[block]);
        let located = blocks.map(|block: usize| {
            let (mut low, mut high) = ((after - step).max(0.0), after);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if self.reserve(block, middle) < 0.0 { high = middle } else { low = middle }
            }
            (high, block)
        });
        let (t, block) = located.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let (x, mut u) = self.at(t);
        let spring = self.springs(x)[block];
        u[block] = self.belt_speed;
        let holds = self.phases[block] != 0.0 && spring.abs() <= self.static_coefficient;
        self.phases[block] = if holds { 0.0 } else { spring.signum() };
        (self.since, self.x, self.u) = (self.since + t, x, u);
        Some(block)
    }
}
