//! Analyses formulas: dimensions, what they depend on, and the names in them. Each number gets the dimension of the terms around
//! it.

use super::dependence::Dependence;
use super::evaluate::FormulaValues;
use super::formula::{Dimension, FormulaFault, FormulaFunction, NONE, Name, Valued, WHOLE};
use super::names::SystemNames;

/// The dimension of a term; a number alone, by its place, fits any dimension.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TermDimension {
    Known(Dimension),
    Any(Vec<usize>),
}

/// The largest exponent of a unit, in twelfths.
const HIGHEST: i32 = 1000 * WHOLE;

/// The analysis of one formula.
pub(super) struct Dimensions<'a> {
    pub names: SystemNames<'a>,
    /// The dimensions of the numbers found so far.
    pub numbers: Vec<Option<Dimension>>,
    /// Whether dimensions are checked: a system without any unit has none.
    pub checks: bool,
    /// The names that have appeared, in their order, with their bodies.
    pub appearing: Vec<(String, Option<i64>)>,
}

/// What the analysis of a term finds.
#[derive(Clone, Debug)]
pub(super) struct TermAnalysis {
    pub measured: TermDimension,
    pub depends: Dependence,
}

/// Returns what the analysis of a term with a known dimension finds.
fn known(dimension: Dimension, depends: Dependence) -> TermAnalysis {
    TermAnalysis { measured: TermDimension::Known(dimension), depends }
}

impl Dimensions<'_> {
    /// Gives a term this dimension.
    pub fn require(&mut self, at: usize, term: TermDimension, wanted: Dimension) -> Valued<()> {
        match term {
            TermDimension::Any(places) => {
                for place in places {
                    self.numbers[place] = Some(wanted);
                }
                Ok(())
            }
            TermDimension::Known(found) if found == wanted || !self.checks => Ok(()),
            TermDimension::Known(found) => {
                let (found, wanted) = (in_words(found), in_words(wanted));
                Err(FormulaFault::new(at, "another quantity", found, wanted))
            }
        }
    }

    /// Returns the dimension of a term; a number alone gets none.
    fn dimension(&mut self, at: usize, term: TermDimension) -> Valued<Dimension> {
        match term {
            TermDimension::Known(dimension) => Ok(dimension),
            any => self.require(at, any, NONE).map(|()| NONE),
        }
    }
}

impl FormulaValues for Dimensions<'_> {
    type Value = TermAnalysis;

    fn number(&mut self, value: f64, _: Dimension, place: usize) -> TermAnalysis {
        // Zero is the same in all units.
        let places = if value == 0.0 { Vec::new() } else { vec![place] };
        TermAnalysis { measured: TermDimension::Any(places), depends: Dependence::default() }
    }

    fn quantity(&mut self, _: f64, dimension: Dimension) -> TermAnalysis {
        known(dimension, Dependence::default())
    }

    fn named(&mut self, at: usize, name: &Name, body: Option<i64>) -> Valued<TermAnalysis> {
        let (meaning, dimension) = self.names.find(at, name, body)?;
        self.appearing.push((name.name.clone(), body));
        Ok(known(dimension, Dependence::of(meaning)))
    }

    fn sum(&mut self, at: usize, terms: Vec<(bool, TermAnalysis)>) -> Valued<TermAnalysis> {
        let depends = terms.iter().map(|(_, term)| term.depends).sum();
        let dimension = terms.iter().find_map(|(_, term)| match term.measured {
            TermDimension::Known(dimension) => Some(dimension),
            TermDimension::Any(_) => None,
        });
        let Some(dimension) = dimension else {
            let all = terms.into_iter().filter_map(|(_, term)| match term.measured {
                TermDimension::Any(places) => Some(places),
                TermDimension::Known(_) => None,
            });
            return Ok(TermAnalysis {
                measured: TermDimension::Any(all.flatten().collect()),
                depends,
            });
        };
        for (_, term) in terms {
            self.require(at, term.measured, dimension).map_err(|fault| FormulaFault {
                problem: "a sum of different quantities".into(),
                ..fault
            })?;
        }
        Ok(known(dimension, depends))
    }

    fn product(&mut self, at: usize, factors: Vec<(bool, TermAnalysis)>) -> Valued<TermAnalysis> {
        let (mut product, mut depends) = (NONE, Dependence::default());
        for (over, factor) in factors {
            depends = depends.times(over, factor.depends);
            for (sum, exponent) in product.iter_mut().zip(self.dimension(at, factor.measured)?) {
                *sum += if over { -exponent } else { exponent };
            }
            limited(at, product)?;
        }
        Ok(known(product, depends))
    }

    fn power(&mut self, at: usize, base: TermAnalysis, exponent: f64) -> Valued<TermAnalysis> {
        let dimension = self.dimension(at, base.measured)?;
        if (2.0 * exponent).fract() != 0.0 || exponent.abs() > 100.0 {
            let allowed = "a multiple of 1/2 up to 100, such as 3 or (1/2)";
            return Err(FormulaFault::new(at, "an exponent", exponent.to_string(), allowed));
        }
        let twice = (2.0 * exponent) as i32;
        let power = dimension.map(|unit| unit * twice / 2);
        limited(at, power)?;
        let depends = if exponent == 1.0 { base.depends } else { base.depends.curved() };
        Ok(known(power, depends))
    }

    fn call(
        &mut self,
        at: usize,
        function: FormulaFunction,
        of: TermAnalysis,
    ) -> Valued<TermAnalysis> {
        let dimension = match function {
            FormulaFunction::SquareRoot => self.dimension(at, of.measured)?.map(|unit| unit / 2),
            _ => {
                self.require(at, of.measured, NONE).map_err(|fault| FormulaFault {
                    problem: "the argument of a function with a dimension".into(),
                    ..fault
                })?;
                NONE
            }
        };
        Ok(known(dimension, of.depends.curved()))
    }
}

/// Refuses a dimension with too high an exponent.
fn limited(at: usize, dimension: Dimension) -> Valued<()> {
    match dimension.iter().any(|exponent| exponent.abs() > HIGHEST) {
        true => Err(FormulaFault::new(at, "too high a power", "a unit", "a lower power")),
        false => Ok(()),
    }
}

/// Units that have names.
const NAMED: [(&str, Dimension); 13] = [
    ("kg", [1, 0, 0]),
    ("m", [0, 1, 0]),
    ("s", [0, 0, 1]),
    ("N", [1, 1, -2]),
    ("N m", [1, 2, -2]),
    ("N/m", [1, 0, -2]),
    ("N s/m", [1, 0, -1]),
    ("N m s", [1, 2, -1]),
    ("W", [1, 2, -3]),
    ("kg m2", [1, 2, 0]),
    ("m/s", [0, 1, -1]),
    ("m/s2", [0, 1, -2]),
    ("1/s", [0, 0, -1]),
];

/// Returns a dimension in words.
fn in_words(dimension: Dimension) -> String {
    if dimension == NONE { "no dimension".to_owned() } else { unit_of(dimension) }
}

/// Returns the SI unit of a dimension; `1` for none.
pub(super) fn unit_of(dimension: Dimension) -> String {
    if dimension == NONE {
        return "1".to_owned();
    }
    let is_it = |(_, named): &&(&str, Dimension)| named.map(|unit| unit * WHOLE) == dimension;
    if let Some((name, _)) = NAMED.iter().find(is_it) {
        return (*name).to_owned();
    }
    let each = ["kg", "m", "s"].iter().zip(dimension).filter(|(_, exponent)| *exponent != 0);
    let each = each.map(|(unit, exponent)| match exponent == WHOLE {
        true => (*unit).to_owned(),
        false => format!("{unit}^{}", f64::from(exponent) / f64::from(WHOLE)),
    });
    each.collect::<Vec<_>>().join(" ")
}
