//! Reads the text of a formula: sums, products, powers, functions, and `sum(body, ...)`.

use super::formula::{
    ComparisonSign, Formula, FormulaFault, FormulaFunction, FormulaTerm, LONGEST_FORMULA, Name,
    TermContent, Valued,
};

/// The deepest nesting of parentheses.
const DEEPEST: usize = 60;

/// The largest number of factors of a product.
const MOST_FACTORS: usize = 64;

/// Functions that are not smooth.
const KINKED: [&str; 11] =
    ["abs", "sign", "sgn", "min", "max", "floor", "ceil", "round", "mod", "heaviside", "step"];

impl Formula {
    /// Parses a text.
    pub fn parse(text: &str) -> Valued<Formula> {
        let (root, numbers) = parsed(text)?;
        Ok(Formula::of_tree(text.to_owned(), root, numbers))
    }
}

/// Returns the tree of a text, and how many numbers it contains.
fn parsed(text: &str) -> Valued<(FormulaTerm, usize)> {
    if text.len() > LONGEST_FORMULA {
        let found = format!("{} bytes", text.len());
        let allowed =
            format!("at most {LONGEST_FORMULA} bytes; give parts of it names as parameters");
        return Err(FormulaFault::new(0, "too long a formula", found, allowed));
    }
    let mut parser = Parser { text, at: 0, depth: 0, numbers: 0 };
    let root = parser.sum()?;
    match parser.next() {
        None => Ok((root, parser.numbers)),
        Some(_) => Err(parser.unexpected(
            "an operator (+ - * / ^); a value with a unit is a parameter, or stands alone",
        )),
    }
}

struct Parser<'t> {
    text: &'t str,
    /// The place of the next character, in bytes.
    at: usize,
    depth: usize,
    /// How many numbers have been read.
    numbers: usize,
}

impl<'t> Parser<'t> {
    fn rest(&self) -> &'t str {
        self.text.get(self.at..).unwrap_or_default()
    }

    /// Returns the next character that is no blank, which comes next.
    fn next(&mut self) -> Option<char> {
        self.at += self.rest().len() - self.rest().trim_start().len();
        self.rest().chars().next()
    }

    /// Passes a text if it comes next.
    fn take(&mut self, wanted: &str) -> bool {
        self.next();
        let comes = self.rest().starts_with(wanted);
        self.at += if comes { wanted.len() } else { 0 };
        comes
    }

    fn unexpected(&mut self, allowed: &str) -> FormulaFault {
        let problem = "not a formula";
        match self.next() {
            None => FormulaFault::new(self.at, problem, "its end", allowed),
            Some(found) => {
                let allowed = match found {
                    '\'' => "a prime only after a coordinate, as in x'",
                    '=' => "`==` for a comparison, which stands only in if(...)",
                    _ => allowed,
                };
                FormulaFault::new(self.at, problem, format!("`{found}`"), allowed)
            }
        }
    }

    fn expect(&mut self, wanted: &str) -> Valued<()> {
        if self.take(wanted) { Ok(()) } else { Err(self.unexpected(&format!("`{wanted}`"))) }
    }

    /// Enters a further level of nesting.
    fn deeper(&mut self) -> Valued<()> {
        self.depth += 1;
        if self.depth <= DEEPEST {
            return Ok(());
        }
        let allowed = format!("at most {DEEPEST} levels of parentheses, signs and powers");
        Err(FormulaFault::new(self.at, "too deep a formula", "one more level", allowed))
    }

    fn sum(&mut self) -> Valued<FormulaTerm> {
        self.next();
        let at = self.at;
        self.deeper()?;
        let is_negative = self.take("-");
        if !is_negative {
            self.take("+");
        }
        let mut terms = vec![(is_negative, self.product()?)];
        while let Some(sign @ ('+' | '-')) = self.next() {
            self.at += 1;
            terms.push((sign == '-', self.product()?));
        }
        self.depth -= 1;
        Ok(joined(at, terms, TermContent::Sum))
    }

    fn product(&mut self) -> Valued<FormulaTerm> {
        self.next();
        let at = self.at;
        let mut factors = vec![(false, self.factor()?)];
        while let Some(sign @ ('*' | '/')) = self.next() {
            self.at += 1;
            factors.push((sign == '/', self.factor()?));
        }
        if factors.len() > MOST_FACTORS {
            let (found, allowed) =
                (format!("{} factors", factors.len()), format!("at most {MOST_FACTORS}"));
            return Err(FormulaFault::new(at, "too long a product", found, allowed));
        }
        Ok(joined(at, factors, TermContent::Product))
    }

    /// A power, or a negative one.
    fn factor(&mut self) -> Valued<FormulaTerm> {
        self.next();
        let at = self.at;
        if self.take("-") {
            self.deeper()?;
            let negative = vec![(true, self.factor()?)];
            self.depth -= 1;
            return Ok(FormulaTerm { at, content: TermContent::Sum(negative) });
        }
        let base = self.atom()?;
        if !(self.take("^") || self.take("**")) {
            return Ok(base);
        }
        self.next();
        let place = self.at;
        let before = self.numbers;
        self.deeper()?;
        let exponent = self.factor()?;
        self.depth -= 1;
        self.numbers = before;
        match constant(&exponent) {
            Some(exponent) => {
                Ok(FormulaTerm { at, content: TermContent::Power(Box::new(base), exponent) })
            }
            None => {
                let found = self.text[place..self.at].trim_end();
                let allowed = "a number, such as 2, -1 or (1/2)";
                Err(FormulaFault::new(place, "not a constant exponent", found, allowed))
            }
        }
    }

    fn atom(&mut self) -> Valued<FormulaTerm> {
        let first = self.next();
        let at = self.at;
        match first {
            Some('(') => {
                self.at += 1;
                let inner = self.sum()?;
                self.expect(")")?;
                Ok(inner)
            }
            Some(digit) if digit.is_ascii_digit() || digit == '.' => self.number(),
            Some(letter) if letter.is_alphabetic() || letter == '_' => self.named(),
            _ => {
                self.at = at;
                Err(self.unexpected("a number, a name, a function or `(`"))
            }
        }
    }

    fn number(&mut self) -> Valued<FormulaTerm> {
        let (at, rest) = (self.at, self.rest());
        let mut end = rest.bytes().take_while(|b| b.is_ascii_digit() || *b == b'.').count();
        let exponent = rest[end..].strip_prefix(['e', 'E']).map(|exponent| {
            let digits = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
            let count = digits.bytes().take_while(u8::is_ascii_digit).count();
            (1 + exponent.len() - digits.len() + count, count)
        });
        if let Some((length, 1..)) = exponent {
            end += length;
        }
        let text = &rest[..end];
        let value = text.parse().ok().filter(|value: &f64| value.is_finite());
        let value = value.ok_or_else(|| {
            FormulaFault::new(at, "not a number", text, "a finite number, such as 0.5 or 1.2e-3")
        })?;
        self.at += end;
        let place = self.numbers;
        self.numbers += 1;
        if self.rest().starts_with(|next: char| next.is_alphabetic() || next == '_') {
            let allowed = "`*` between a number and a name; a value with a unit is a parameter";
            return Err(self.unexpected(allowed));
        }
        Ok(FormulaTerm { at, content: TermContent::Number(value, place) })
    }

    fn name(&mut self) -> &'t str {
        self.next();
        let rest = self.rest();
        let is_part = |letter: char| letter.is_alphanumeric() || letter == '_';
        let end = rest.find(|letter| !is_part(letter)).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    fn named(&mut self) -> Valued<FormulaTerm> {
        let at = self.at;
        let name = self.name();
        if self.next() == Some('(') {
            return self.call(at, name);
        }
        let mut primes = self.primes();
        let mut body = None;
        if self.take("[") {
            let before = self.numbers;
            body = Some(Box::new(self.sum()?));
            self.numbers = before;
            self.expect("]")?;
            primes += self.primes();
        }
        Ok(FormulaTerm {
            at,
            content: TermContent::Name(Name { name: name.to_owned(), primes, body }),
        })
    }

    fn primes(&mut self) -> usize {
        let mut primes = 0;
        while self.take("'") {
            primes += 1;
        }
        primes
    }

    fn call(&mut self, at: usize, name: &str) -> Valued<FormulaTerm> {
        self.expect("(")?;
        let content = match (name, FormulaFunction::ALL.iter().find(|known| known.name() == name)) {
            ("sum", _) => {
                let index = self.name().to_owned();
                self.expect(",")?;
                TermContent::SumOver(index, Box::new(self.sum()?))
            }
            ("if", _) => self.choice()?,
            (_, Some(function)) => TermContent::Call(*function, Box::new(self.sum()?)),
            _ => return Err(unknown_function(at, name)),
        };
        self.expect(")")?;
        Ok(FormulaTerm { at, content })
    }

    fn choice(&mut self) -> Valued<TermContent> {
        let before = self.numbers;
        let left = self.sum()?;
        let comparison = ComparisonSign::ALL.iter().find(|(sign, _)| self.take(sign));
        let Some((_, comparison)) = comparison else {
            return Err(
                self.unexpected("a comparison of whole numbers, as in if(block < blocks, ...)")
            );
        };
        let right = self.sum()?;
        self.numbers = before;
        self.expect(",")?;
        let then = self.sum()?;
        self.expect(",")?;
        let otherwise = self.sum()?;
        Ok(TermContent::If(Box::new([left, right]), *comparison, Box::new([then, otherwise])))
    }
}

/// Returns a term of several parts, or its only part.
fn joined(
    at: usize,
    mut parts: Vec<(bool, FormulaTerm)>,
    all: fn(Vec<(bool, FormulaTerm)>) -> TermContent,
) -> FormulaTerm {
    match (parts.len(), parts.pop()) {
        (1, Some((false, only))) => only,
        (_, last) => {
            parts.extend(last);
            FormulaTerm { at, content: all(parts) }
        }
    }
}

/// Returns the value of a term of numbers.
fn constant(term: &FormulaTerm) -> Option<f64> {
    match &term.content {
        TermContent::Number(value, _) => Some(*value),
        TermContent::Sum(terms) => terms.iter().try_fold(0.0, |sum, (minus, term)| {
            constant(term).map(|value| if *minus { sum - value } else { sum + value })
        }),
        TermContent::Product(factors) => factors.iter().try_fold(1.0, |product, (over, factor)| {
            constant(factor).map(|value| if *over { product / value } else { product * value })
        }),
        _ => None,
    }
    .filter(|value| value.is_finite())
}

fn unknown_function(at: usize, name: &str) -> FormulaFault {
    let names: Vec<&str> = FormulaFunction::ALL.iter().map(|known| known.name()).collect();
    let all = format!("{}, sum and if", names.join(", "));
    if KINKED.contains(&name) {
        let allowed = format!(
            "a smooth function ({all}); what has a kink or a jump is a contact with a gap or with friction"
        );
        return FormulaFault::new(at, "a function that is not smooth", name, allowed);
    }
    let allowed = match name {
        "ln" => format!("{all}; log is the natural logarithm"),
        _ => format!("{all}; a product needs `*`"),
    };
    FormulaFault::new(at, "unknown function", name, allowed)
}
