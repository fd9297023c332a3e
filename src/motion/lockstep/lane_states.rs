//! States of a lane inside its latest step, from the step's series.

use std::f64::consts::TAU;

use fearless_simd::Simd;

use super::section_crossing::state_at;
use super::{Group, Room};

impl<S: Simd, const N: usize> Group<S, N> {
    /// Returns the angles of a lane's balls at a time after the start of its latest step, including
    /// the whole turns since the start.
    #[inline(never)]
    pub(crate) fn angles_within(&self, room: &Room<S, N>, lane: usize, after: f64) -> [f64; N] {
        let start = self.before.lane(lane);
        let state = self.time.simd.vectorize(
            #[inline(always)]
            || state_at(&room.series, lane, &start, after),
        );
        std::array::from_fn(|ball| {
            // Turns are counted at the step's end.
            let end = room.end.angle[ball][lane];
            let counted = ((end - self.state.angle[ball][lane]) / TAU).round();
            state.beta[ball] + (self.turns[ball][lane] - counted) * TAU
        })
    }

    /// Returns the squares of the table's displacement in a lane at several times after the start
    /// of its latest step.
    #[inline(never)]
    pub(crate) fn squares_within<const P: usize>(
        &self,
        room: &Room<S, N>,
        lane: usize,
        after: [f64; P],
    ) -> [f64; P] {
        // The fused multiply-add is an instruction in this closure.
        self.time.simd.vectorize(
            #[inline(always)]
            || {
                let (mut x, mut y) = ([0.0_f64; P], [0.0_f64; P]);
                for term in room.series.terms.iter().rev() {
                    let coefficients = [term.table[0][lane], term.table[1][lane]];
                    for place in 0..P {
                        x[place] = x[place].mul_add(after[place], coefficients[0]);
                        y[place] = y[place].mul_add(after[place], coefficients[1]);
                    }
                }
                std::array::from_fn(|place| x[place] * x[place] + y[place] * y[place])
            },
        )
    }
}
