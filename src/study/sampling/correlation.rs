//! Correlated draws by a Gaussian copula.
//!
//! Uniform fractions become normal numbers, a Cholesky factor correlates these, and the normal distribution function
//! turns them into uniform fractions again, so that every parameter keeps its distribution. The normal correlation of a
//! Spearman rank correlation `ρ` is `2 sin(π ρ / 6)` (W. H. Kruskal, "Ordinal measures of association", Journal of the
//! American Statistical Association 53 (1958) 814; A. J. McNeil, R. Frey and P. Embrechts, "Quantitative Risk
//! Management", theorem 5.36).

use std::f64::consts::PI;

use nalgebra::{Cholesky, DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, Normal};

/// The smallest variance that the earlier parameters leave to a parameter. A smaller one is zero but for rounding.
const MIN_REMAINING_VARIANCE: f64 = 1.0e-10;

/// The rank correlation of two parameters, which are given by their places; the first place is the smaller one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CorrelatedPair {
    /// Places of the two parameters.
    pub places: [usize; 2],
    /// Spearman's rank correlation.
    pub value: f64,
}

/// A Gaussian copula of some parameters.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Copula {
    /// For each parameter, its row of the Cholesky factor without zeros; empty for a parameter that does not depend on
    /// earlier ones, whose fraction stays as it is.
    rows: Vec<Vec<(usize, f64)>>,
}

/// Rank correlations that no distribution has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contradiction {
    /// Index of the pair among the given rank correlations: it belongs to the parameter at which the leading principal
    /// minor of the normal correlations is no longer positive.
    pub pair: usize,
    /// Place of this parameter.
    pub place: usize,
    /// The rank correlations of the pair that the other pairs of these parameters leave possible, rounded inwards.
    pub possible: Option<[f64; 2]>,
}

impl Copula {
    /// Creates the copula of `count` parameters.
    pub fn new(count: usize, pairs: &[CorrelatedPair]) -> Result<Copula, Contradiction> {
        let mut matrix = DMatrix::<f64>::identity(count, count);
        for CorrelatedPair { places: [row, column], value } in pairs {
            let normal = normal_correlation(*value);
            matrix[(*row, *column)] = normal;
            matrix[(*column, *row)] = normal;
        }
        let mut rows = vec![Vec::new(); count];
        for place in 1..count {
            let earlier = |pair: &CorrelatedPair| pair.places[1] == place && pair.value != 0.0;
            if !pairs.iter().any(earlier) {
                continue;
            }
            let leading = matrix.view((0, 0), (place + 1, place + 1));
            let factor = Cholesky::new(leading.into_owned()).map(Cholesky::unpack);
            let factor = factor
                .filter(|factor| factor[(place, place)].powi(2) > MIN_REMAINING_VARIANCE)
                .ok_or_else(|| contradiction(&matrix, place, pairs))?;
            let entries = (0..=place).map(|column| (column, factor[(place, column)]));
            rows[place] = entries.filter(|(_, entry)| *entry != 0.0).collect();
        }
        Ok(Copula { rows })
    }

    /// Correlates uniform fractions strictly between 0 and 1, one for each parameter.
    pub fn correlate(&self, fractions: &[f64]) -> Vec<f64> {
        let standard = Normal::standard();
        let correlated = |(row, fraction): (&Vec<(usize, f64)>, &f64)| {
            if row.is_empty() {
                return *fraction;
            }
            let normal = row
                .iter()
                .map(|(column, entry)| entry * standard.inverse_cdf(fractions[*column]))
                .sum();
            standard.cdf(normal).clamp(f64::MIN_POSITIVE, 1.0_f64.next_down())
        };
        self.rows.iter().zip(fractions).map(correlated).collect()
    }
}

/// Returns the correlation of two normal numbers with this rank correlation.
fn normal_correlation(rank: f64) -> f64 {
    2.0 * libm::sin(PI * rank / 6.0)
}

/// Returns the rank correlation of two normal numbers with this correlation.
fn rank_correlation(normal: f64) -> f64 {
    6.0 / PI * (normal / 2.0).clamp(-0.5, 0.5).asin()
}

/// Returns the last of a parameter's pairs whose change alone makes the leading minor positive, or the last pair if
/// there is none.
fn contradiction(matrix: &DMatrix<f64>, place: usize, pairs: &[CorrelatedPair]) -> Contradiction {
    let of_place = || {
        let all = pairs.iter().enumerate().rev();
        all.filter(|(_, pair)| pair.places[1] == place)
    };
    let with_range = of_place().find_map(|(pair, correlated)| {
        let possible = possible_range(matrix, correlated.places[0], place)?;
        Some(Contradiction { pair, place, possible: Some(possible) })
    });
    let last = of_place().next().map_or(0, |(pair, _)| pair);
    with_range.unwrap_or(Contradiction { pair: last, place, possible: None })
}

/// Returns the rank correlations of two parameters with which the leading minor up to the later one is positive, with all
/// other correlations as they are: those with a partial correlation between -1 and 1.
fn possible_range(matrix: &DMatrix<f64>, earlier: usize, later: usize) -> Option<[f64; 2]> {
    let others: Vec<usize> = (0..later).filter(|other| *other != earlier).collect();
    let among = DMatrix::from_fn(others.len(), others.len(), |row, column| {
        matrix[(others[row], others[column])]
    });
    let with = |place: usize| {
        DVector::from_iterator(others.len(), others.iter().map(|other| matrix[(*other, place)]))
    };
    let (with_earlier, with_later) = (with(earlier), with(later));
    let among = Cholesky::new(among)?;
    let (solved_earlier, solved) = (among.solve(&with_earlier), among.solve(&with_later));
    let left = [1.0 - with_earlier.dot(&solved_earlier), 1.0 - with_later.dot(&solved)];
    if left.iter().any(|variance| *variance <= MIN_REMAINING_VARIANCE) {
        return None;
    }
    let (centre, half) = (with_earlier.dot(&solved), (left[0] * left[1]).sqrt());
    let low = ((rank_correlation(centre - half) * 1e3).floor() + 1.0) / 1e3;
    let high = ((rank_correlation(centre + half) * 1e3).ceil() - 1.0) / 1e3;
    (low <= high).then_some([low, high])
}

#[cfg(test)]
mod tests {
    use super::{Contradiction, Copula, CorrelatedPair, normal_correlation, rank_correlation};

    fn pairs(pairs: &[(usize, usize, f64)]) -> Vec<CorrelatedPair> {
        let pair = |&(first, second, value)| CorrelatedPair { places: [first, second], value };
        pairs.iter().map(pair).collect()
    }

    #[test]
    fn rank_correlations_become_normal_ones_and_back() {
        for (rank, normal) in [(0.0, 0.0), (1.0, 1.0), (-1.0, -1.0), (0.5, 0.517_638_090_205_041_5)]
        {
            assert!((normal_correlation(rank) - normal).abs() < 1e-15, "{rank}");
            assert!((rank_correlation(normal) - rank).abs() < 1e-15, "{normal}");
        }
    }

    /// With one pair, the second normal number is `r z_1 + sqrt(1 - r²) z_2`, written out for the quartiles.
    #[test]
    fn a_pair_agrees_with_the_closed_form() {
        let copula = Copula::new(3, &pairs(&[(0, 2, 0.5)])).expect("a copula");
        let quartile = 0.674_489_750_196_081_7;
        let normal = normal_correlation(0.5);
        for (fractions, sign) in [([0.75, 0.3, 0.75], 1.0), ([0.75, 0.3, 0.25], -1.0)] {
            let correlated = copula.correlate(&fractions);
            assert_eq!(correlated[..2], fractions[..2]);
            let expected = quartile * (normal + sign * (1.0 - normal * normal).sqrt());
            let found = super::Normal::standard();
            let found = super::ContinuousCDF::inverse_cdf(&found, correlated[2]);
            // The distribution function of statrs has an error of about 1e-11.
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
    }

    #[test]
    fn a_copula_without_correlations_changes_nothing() {
        let copula = Copula::new(3, &pairs(&[(0, 1, 0.0)])).expect("a copula");
        let fractions = [1e-300, 0.1, 1.0_f64.next_down()];
        assert_eq!(copula.correlate(&fractions), fractions);
    }

    /// The extremes of the draws stay strictly between 0 and 1, so that every quantile is finite.
    #[test]
    fn extreme_draws_stay_inside() {
        let copula = Copula::new(2, &pairs(&[(0, 1, 0.7)])).expect("a copula");
        for extreme in [0.5_f64.powi(53), 1.0 - 0.5_f64.powi(53)] {
            let correlated = copula.correlate(&[extreme; 2]);
            assert!(0.0 < correlated[1] && correlated[1] < 1.0, "{correlated:?}");
        }
    }

    #[test]
    fn the_first_impossible_parameter_is_named() {
        // The pairs of places 1 and 2 agree; those of place 3 contradict them.
        let all = [(0, 3, 0.9), (0, 1, 0.9), (1, 3, -0.9), (0, 2, 0.2)];
        let found = Copula::new(4, &pairs(&all)).expect_err("no copula");
        let Contradiction { pair, place, possible } = found;
        assert_eq!((pair, place), (2, 3));
        let [low, high] = possible.expect("a range");
        for (value, fits) in [(low, true), (high, true), (low - 2e-3, false), (high + 2e-3, false)]
        {
            let mut all = all;
            all[2].2 = value;
            assert_eq!(Copula::new(4, &pairs(&all)).is_ok(), fits, "{value}");
        }
        // No value of one pair repairs two contradictions of a parameter.
        let all =
            [(0, 1, 0.95), (2, 3, 0.95), (0, 4, 0.9), (1, 4, -0.9), (2, 4, 0.9), (3, 4, -0.9)];
        let found = Copula::new(5, &pairs(&all)).expect_err("no copula");
        assert_eq!(found, Contradiction { pair: 5, place: 4, possible: None });
    }
}
