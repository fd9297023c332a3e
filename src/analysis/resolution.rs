//! Limits and defaults of the resolution of equilibrium sets.

use std::ops::RangeInclusive;

use super::equilibrium_set::Resolution;
use super::set_samples::REPLICATES;
use crate::numbers::counted;

/// Largest number of positions at one sweep point.
const MOST_POSITIONS: u64 = 1 << 26;
/// Largest number of balls whose sets are computed on a grid.
const MOST_ON_GRID: usize = 2;
/// Smallest number of grid points per axis.
pub const FEWEST_GRID_POINTS: usize = 8;
/// Smallest and largest number of samples: each scramble has at most 2^16 Sobol' points.
pub const SAMPLE_COUNTS: [u32; 2] = [64 * REPLICATES, REPLICATES << 16];
/// Largest viscous drag on the balls; above it, the slow eigenvalues are lost in rounding errors.
pub const MOST_BALL_DAMPING: f64 = 1e5;

/// The resolution of the sets of machines with different numbers of balls.
#[derive(Clone, Copy, Debug)]
pub struct Resolutions {
    /// For one or two balls; that of more balls if no machine has so few.
    pub few: Resolution,
    /// For three or more balls; that of few balls if no machine has so many.
    pub more: Resolution,
}

impl Resolutions {
    /// Chooses the resolutions for these numbers of balls like [`Resolution::choose`].
    ///
    /// # Errors
    /// An option that applies to none of the numbers of balls, or a grid that is too fine.
    pub fn choose(
        balls: RangeInclusive<usize>,
        grid: Option<usize>,
        samples: Option<u32>,
    ) -> Result<Resolutions, String> {
        let (fewest, most) = (*balls.start(), *balls.end());
        if fewest > MOST_ON_GRID || most <= MOST_ON_GRID {
            let all = Resolution::choose(most, grid, samples)?;
            return Ok(Resolutions { few: all, more: all });
        }
        let few = Resolution::choose(MOST_ON_GRID, grid, None)?;
        let more = Resolution::choose(most, None, samples)?;
        Ok(Resolutions { few, more })
    }

    /// Returns the resolution for a number of balls.
    pub fn of(&self, balls: usize) -> Resolution {
        if balls > MOST_ON_GRID { self.more } else { self.few }
    }
}

impl Resolution {
    /// Chooses the resolution for a number of balls from the options `--grid` (points per axis) and
    /// `--samples` (samples in all). The defaults are 512 points for one or two balls, and 65,536
    /// samples for more.
    ///
    /// # Errors
    /// An option that does not apply to this number of balls, or a grid that is too fine; the
    /// message names the remedy.
    pub fn choose(
        balls: usize,
        grid: Option<usize>,
        samples: Option<u32>,
    ) -> Result<Resolution, String> {
        let refused = |option: &str, found: &str, allowed: &str| {
            Err(format!("{option}\n  found:   {found}\n  allowed: {allowed}"))
        };
        let resolution = match (balls, grid, samples) {
            (1 | 2, _, Some(_)) => {
                let found = format!("a study with {}", counted(balls, "ball"));
                let allowed = "--grid G for one ball or two, whose sets are computed on a grid";
                return refused("--samples serves three balls or more", &found, allowed);
            }
            (_, Some(_), _) if balls > 2 => {
                let found = format!("a study with {balls} balls");
                let allowed = "--samples SAMPLES for three balls or more, whose sets are sampled";
                return refused("--grid serves one ball or two", &found, allowed);
            }
            (1 | 2, points, _) => Resolution::Grid(points.unwrap_or(512)),
            (_, _, samples) => Resolution::Samples(samples.unwrap_or(1 << 16) / REPLICATES),
        };
        if let Resolution::Grid(points) = resolution
            && resolution.positions(balls).is_none_or(|positions| positions > MOST_POSITIONS)
        {
            let total = (points as f64).powi(balls as i32);
            let most = (MOST_POSITIONS as f64).powf(1.0 / balls as f64).round();
            let balls = counted(balls, "ball");
            let found = format!("{points} points per axis: {total} in all for {balls}");
            let allowed = format!("at most {most} points per axis, {MOST_POSITIONS} in all");
            return refused("--grid is too fine", &found, &allowed);
        }
        Ok(resolution)
    }
}
