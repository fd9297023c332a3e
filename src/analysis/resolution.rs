//! How finely equilibrium sets may be looked at, and what is taken where nothing is asked for.

use super::equilibrium_set::Resolution;
use super::set_samples::REPLICATES;

/// Most positions at one point of the sweep.
const MOST_POSITIONS: u64 = 1 << 26;
/// Fewest points of a grid per axis.
pub const FEWEST_GRID_POINTS: usize = 8;
/// Fewest and most samples: Sobol' points are known up to 2^16 in each scramble.
pub const SAMPLE_COUNTS: [u32; 2] = [64 * REPLICATES, REPLICATES << 16];
/// More viscous drag on the balls than this leaves nothing of the slow eigenvalues but rounding.
pub const MOST_BALL_DAMPING: f64 = 1e5;

impl Resolution {
    /// For so many balls: a grid of so many points per axis, or so many samples in all, as asked for with
    /// the options `--grid` and `--samples`; 512 points of one ball or two, 65,536 samples of more.
    ///
    /// # Errors
    /// An option that serves another number of balls, or too fine a grid, with the remedy.
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
                let found = format!("a study with {balls} {}", plural(balls));
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
            let found =
                format!("{points} points per axis: {total} in all for {balls} {}", plural(balls));
            let allowed = format!("at most {most} points per axis, {MOST_POSITIONS} in all");
            return refused("--grid is too fine", &found, &allowed);
        }
        Ok(resolution)
    }
}

fn plural(balls: usize) -> &'static str {
    if balls == 1 { "ball" } else { "balls" }
}
