//! A formula of a system file: its text and its tree.

use std::sync::OnceLock;

use crate::named::named;

/// The longest text of a formula, in bytes.
pub const LONGEST_FORMULA: usize = 10_000;

/// A formula. Each of its numbers has the dimension that the terms around it have.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// The text.
    pub text: String,
    pub(super) root: FormulaTerm,
    /// How many numbers it contains.
    pub(super) numbers: usize,
    /// The dimension of each number, by its place in the text, once a check has found it.
    pub(super) dimensions: OnceLock<Vec<Dimension>>,
}

/// What is wrong in a formula.
#[derive(Clone, Debug, PartialEq)]
pub struct FormulaFault {
    /// Where, in bytes from the beginning of the text.
    pub at: usize,
    /// What is wrong, in a few words.
    pub problem: String,
    /// What was found.
    pub found: String,
    /// What is allowed, or what to do; empty if it is one of `names`.
    pub allowed: String,
    /// The known names, if an unknown one was found.
    pub names: Box<[String]>,
}

/// What a formula gives, or what is wrong in it.
pub(super) type Valued<T> = Result<T, FormulaFault>;

impl FormulaFault {
    pub(super) fn new(
        at: usize,
        problem: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        let (problem, found, allowed) = (problem.into(), found.into(), allowed.into());
        FormulaFault { at, problem, found, allowed, names: Box::default() }
    }
}

/// Exponents of mass, length and time, in twelfths; an angle has no dimension.
pub type Dimension = [i32; 3];

/// Twelfths in one: exponents of a dimension are multiples of a twelfth, so that it has square and cube roots.
pub const WHOLE: i32 = 12;

/// No dimension.
pub const NONE: Dimension = [0; 3];

/// A part of a formula.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FormulaTerm {
    /// Where it begins, in bytes.
    pub at: usize,
    pub content: TermContent,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum TermContent {
    /// A number, with its place among the numbers of the formula.
    Number(f64, usize),
    /// A number in an SI unit of this dimension.
    Quantity(f64, Dimension),
    Name(Name),
    /// Terms that are added, or subtracted where the flag is set.
    Sum(Vec<(bool, FormulaTerm)>),
    /// Factors that are multiplied, or divided by where the flag is set.
    Product(Vec<(bool, FormulaTerm)>),
    /// A power with a constant exponent.
    Power(Box<FormulaTerm>, f64),
    Call(FormulaFunction, Box<FormulaTerm>),
    /// The sum over all bodies that an index counts.
    SumOver(String, Box<FormulaTerm>),
    /// One of two terms, by a comparison of whole numbers.
    If(Box<[FormulaTerm; 2]>, ComparisonSign, Box<[FormulaTerm; 2]>),
}

/// A coordinate, its rate of change, a parameter, the time, an index or π.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Name {
    pub name: String,
    /// The number of primes: 1 for a rate of change.
    pub primes: usize,
    /// The number of the body, for a coordinate of several bodies.
    pub body: Option<Box<FormulaTerm>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FormulaFunction {
    Sine,
    Cosine,
    Tangent,
    Exponential,
    SquareRoot,
    HyperbolicTangent,
    ArcTangent,
    Logarithm,
}

named!(FormulaFunction {
    Sine: "sin",
    Cosine: "cos",
    Tangent: "tan",
    Exponential: "exp",
    SquareRoot: "sqrt",
    HyperbolicTangent: "tanh",
    ArcTangent: "atan",
    Logarithm: "log",
});

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ComparisonSign {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    Unequal,
}

impl ComparisonSign {
    pub const ALL: [(&str, ComparisonSign); 6] = [
        ("<=", ComparisonSign::LessOrEqual),
        (">=", ComparisonSign::GreaterOrEqual),
        ("==", ComparisonSign::Equal),
        ("!=", ComparisonSign::Unequal),
        ("<", ComparisonSign::Less),
        (">", ComparisonSign::Greater),
    ];

    pub fn holds(self, left: i64, right: i64) -> bool {
        match self {
            ComparisonSign::Less => left < right,
            ComparisonSign::LessOrEqual => left <= right,
            ComparisonSign::Greater => left > right,
            ComparisonSign::GreaterOrEqual => left >= right,
            ComparisonSign::Equal => left == right,
            ComparisonSign::Unequal => left != right,
        }
    }
}

impl Formula {
    /// Returns the formula of a value in the SI unit of a dimension.
    pub fn quantity(value: f64, dimension: Dimension) -> Formula {
        let root = FormulaTerm { at: 0, content: TermContent::Quantity(value, dimension) };
        Formula::of_tree(value.to_string(), root, 0)
    }

    /// Returns the formula of a number.
    pub fn number(value: f64) -> Formula {
        let root = FormulaTerm { at: 0, content: TermContent::Number(value, 0) };
        Formula::of_tree(value.to_string(), root, 1)
    }

    /// Returns the formula of a tree with this many numbers.
    pub(super) fn of_tree(text: String, root: FormulaTerm, numbers: usize) -> Formula {
        Formula { text, root, numbers, dimensions: OnceLock::new() }
    }

    /// Returns the dimension of a number; none before a check has found it.
    pub(super) fn dimension_of(&self, number: usize) -> Dimension {
        self.dimensions.get().map_or(NONE, |all| all[number])
    }
}
