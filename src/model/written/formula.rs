//! A formula of a system file: its text and its tree.

/// The longest text of a formula, in bytes.
pub const LONGEST_FORMULA: usize = 10_000;

/// A formula. Each of its numbers has the dimension that the terms around it have.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// The text.
    pub text: String,
    pub(super) root: Term,
    /// The dimension of each number, by its place in the text.
    pub(super) numbers: Vec<Dimension>,
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
pub(super) struct Term {
    /// Where it begins, in bytes.
    pub at: usize,
    pub content: Content,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Content {
    /// A number, with its place among the numbers of the formula.
    Number(f64, usize),
    /// A number in an SI unit of this dimension.
    Quantity(f64, Dimension),
    Name(Name),
    /// Terms that are added, or subtracted where the flag is set.
    Sum(Vec<(bool, Term)>),
    /// Factors that are multiplied, or divided by where the flag is set.
    Product(Vec<(bool, Term)>),
    /// A power with a constant exponent.
    Power(Box<Term>, f64),
    Call(Function, Box<Term>),
    /// The sum over all bodies that an index counts.
    SumOver(String, Box<Term>),
    /// One of two terms, by a comparison of whole numbers.
    If(Box<[Term; 2]>, Comparison, Box<[Term; 2]>),
}

/// A coordinate, its rate of change, a parameter, the time, an index or π.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Name {
    pub name: String,
    /// The number of primes: 1 for a rate of change.
    pub primes: usize,
    /// The number of the body, for a coordinate of several bodies.
    pub body: Option<Box<Term>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Function {
    Sine,
    Cosine,
    Tangent,
    Exponential,
    SquareRoot,
    HyperbolicTangent,
    ArcTangent,
    Logarithm,
}

impl Function {
    pub const ALL: [(&str, Function); 8] = [
        ("sin", Function::Sine),
        ("cos", Function::Cosine),
        ("tan", Function::Tangent),
        ("exp", Function::Exponential),
        ("sqrt", Function::SquareRoot),
        ("tanh", Function::HyperbolicTangent),
        ("atan", Function::ArcTangent),
        ("log", Function::Logarithm),
    ];
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    Unequal,
}

impl Comparison {
    pub const ALL: [(&str, Comparison); 6] = [
        ("<=", Comparison::LessOrEqual),
        (">=", Comparison::GreaterOrEqual),
        ("==", Comparison::Equal),
        ("!=", Comparison::Unequal),
        ("<", Comparison::Less),
        (">", Comparison::Greater),
    ];

    pub fn holds(self, one: i64, other: i64) -> bool {
        match self {
            Comparison::Less => one < other,
            Comparison::LessOrEqual => one <= other,
            Comparison::Greater => one > other,
            Comparison::GreaterOrEqual => one >= other,
            Comparison::Equal => one == other,
            Comparison::Unequal => one != other,
        }
    }
}

impl Formula {
    /// Returns the formula of a value in the SI unit of a dimension.
    pub fn quantity(value: f64, dimension: Dimension) -> Formula {
        let root = Term { at: 0, content: Content::Quantity(value, dimension) };
        Formula { text: value.to_string(), root, numbers: Vec::new() }
    }

    /// Returns the formula of a number.
    pub fn number(value: f64) -> Formula {
        let root = Term { at: 0, content: Content::Number(value, 0) };
        Formula { text: value.to_string(), root, numbers: vec![NONE] }
    }
}
