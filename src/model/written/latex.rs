//! The equations of a system in LaTeX, for notebooks: its mass matrix, its forces and its contacts.

use super::definition::SystemDefinition;
use super::evaluate::{Bodies, FormulaValues};
use super::formula::{Dimension, Formula, FormulaFunction, Name, Valued};
use super::instance::Instance;

/// How tightly the last operation of a text binds.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Power,
}

/// A text, and how tightly its last operation binds.
type Text = (String, Binding);

struct LatexValues;

impl SystemDefinition {
    /// Returns the equations in LaTeX, with the default numbers of bodies; `None` if a formula has a fault.
    pub fn latex(&self) -> Option<String> {
        let instance = Instance::new(self, |name| self.default_count(name)).ok()?;
        instance.latex().ok()
    }
}

impl Instance<'_> {
    fn latex(&self) -> Valued<String> {
        let n = self.coordinates.len();
        let text = |formula: &Formula, mut bodies: Bodies| {
            Ok(bodies.evaluate(formula, &mut LatexValues)?.0)
        };
        let mut mass = vec![vec!["0".to_owned(); n]; n];
        for ([row, column], formula) in &self.definition.mass {
            for ([row, column], bodies) in self.places([row, column]).map_err(|(_, fault)| fault)? {
                let entry = text(formula, bodies)?;
                mass[row][column].clone_from(&entry);
                mass[column][row] = entry;
            }
        }
        let mut forces = vec![Vec::new(); n];
        for (place, formula) in &self.definition.force {
            for ([number], bodies) in self.places([place]).map_err(|(_, fault)| fault)? {
                let term = bodies.clone().evaluate(formula, &mut LatexValues)?;
                forces[number].push((false, term));
            }
        }
        let total = |terms: Vec<_>| match terms.is_empty() {
            true => Ok("0".to_owned()),
            false => LatexValues.sum(0, terms).map(|(text, _)| text),
        };
        let forces = forces.into_iter().map(total).collect::<Valued<Vec<_>>>()?;
        let accelerations = self
            .coordinates
            .iter()
            .map(|member| symbol(&self.definition.coordinates[member.of].name, 2, member.body));
        let rows = mass.into_iter().map(|row| row.join(" & ")).collect::<Vec<_>>();
        let mut lines = vec![format!(
            "& {} {} = {} + \\text{{contacts}}",
            matrix(&rows),
            matrix(&accelerations.collect::<Vec<_>>()),
            matrix(&forces)
        )];
        for number in 0..self.contacts.len() {
            let (contact, bodies) = self.contact(number);
            let (key, formula) = contact.normal.entry();
            let mut parts = vec![format!("\\text{{{key}}} = {}", text(formula, bodies.clone())?)];
            if let Some(sliding) = &contact.sliding {
                parts.push(format!("\\text{{sliding}} = {}", text(sliding, bodies.clone())?));
            }
            let body =
                self.contacts[number].body.map_or_else(String::new, |body| format!(" {body}"));
            let name = format!("{}{body}", contact.name.replace('_', " "));
            lines.push(format!("& \\text{{{name}: }} {}", parts.join(", \\quad ")));
        }
        Ok(format!("$\\displaystyle \\begin{{aligned}} {} \\end{{aligned}}$", lines.join(" \\\\ ")))
    }
}

/// Returns a matrix with these rows.
fn matrix(rows: &[String]) -> String {
    format!("\\begin{{bmatrix}} {} \\end{{bmatrix}}", rows.join(" \\\\ "))
}

/// The names of Greek letters, which are symbols of their own.
const GREEK: [&str; 28] = [
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "kappa", "lambda", "mu",
    "nu", "xi", "rho", "sigma", "tau", "phi", "chi", "psi", "omega", "Gamma", "Delta", "Theta",
    "Lambda", "Sigma", "Phi", "Psi", "Omega",
];

/// Returns a name with dots for its primes; what follows the first `_`, and the number of a body, are its index.
fn symbol(name: &str, primes: usize, body: Option<i64>) -> String {
    let (stem, rest) = name.split_once('_').unwrap_or((name, ""));
    let letter = match (GREEK.contains(&stem), stem.len()) {
        (true, _) => format!("\\{stem}"),
        (false, 1) => stem.to_owned(),
        (false, _) => format!("\\mathit{{{stem}}}"),
    };
    let dotted = match primes {
        0 => letter,
        1 => format!("\\dot{{{letter}}}"),
        _ => format!("\\ddot{{{letter}}}"),
    };
    let words = (!rest.is_empty()).then(|| format!("\\mathrm{{{}}}", rest.replace('_', "\\,")));
    let index: Vec<String> = words.into_iter().chain(body.map(|body| body.to_string())).collect();
    if index.is_empty() { dotted } else { format!("{dotted}_{{{}}}", index.join(",")) }
}

/// Returns a text in parentheses if its last operation binds less tightly.
fn bound((text, binding): Text, least: Binding) -> String {
    if binding < least { format!("\\left({text}\\right)") } else { text }
}

impl FormulaValues for LatexValues {
    type Value = Text;

    fn number(&mut self, value: f64, _: Dimension, _: usize) -> Text {
        let plain = value == 0.0 || (1e-3..1e6).contains(&value.abs());
        let text = if plain { value.to_string() } else { format!("{value:e}") };
        match text.split_once('e') {
            Some(("1", power)) => (format!("10^{{{power}}}"), Binding::Product),
            Some((digits, power)) => (format!("{digits} \\cdot 10^{{{power}}}"), Binding::Product),
            None if value < 0.0 => (text, Binding::Sum),
            None => (text, Binding::Power),
        }
    }

    fn named(&mut self, _: usize, name: &Name, body: Option<i64>) -> Valued<Text> {
        let text = if name.name == "pi" {
            "\\pi".to_owned()
        } else {
            symbol(&name.name, name.primes, body)
        };
        Ok((text, Binding::Power))
    }

    fn sum(&mut self, _: usize, terms: Vec<(bool, Text)>) -> Valued<Text> {
        let mut sum = String::new();
        for (minus, term) in terms {
            let text = bound(term, if minus { Binding::Product } else { Binding::Sum });
            // A term such as `-a` in a sum within a sum has its sign.
            let (minus, text) = match text.strip_prefix('-') {
                Some(rest) if !minus && !sum.is_empty() => (true, rest),
                _ => (minus, text.as_str()),
            };
            sum += match (minus, sum.is_empty()) {
                (true, true) => "-",
                (true, false) => " - ",
                (false, false) => " + ",
                (false, true) => "",
            };
            sum += text;
        }
        Ok((sum, Binding::Sum))
    }

    fn product(&mut self, _: usize, factors: Vec<(bool, Text)>) -> Valued<Text> {
        let all = |wanted: bool, least: Binding| {
            let chosen = factors.iter().filter(|(over, _)| *over == wanted);
            let texts: Vec<String> =
                chosen.map(|(_, factor)| bound(factor.clone(), least)).collect();
            let mut product = String::new();
            for text in texts {
                let is_number = text.starts_with(|first: char| first.is_ascii_digit());
                product += match (product.is_empty(), is_number) {
                    (true, _) => "",
                    (false, true) => " \\cdot ",
                    (false, false) => " \\, ",
                };
                product += &text;
            }
            product
        };
        let count = |wanted: bool| factors.iter().filter(|(over, _)| *over == wanted).count();
        // A sum alone needs no parentheses above or below the line of a fraction.
        let least = |wanted: bool| if count(wanted) > 1 { Binding::Product } else { Binding::Sum };
        Ok(match count(true) {
            0 => (all(false, Binding::Product), Binding::Product),
            _ => {
                let above = all(false, least(false));
                let above = if above.is_empty() { "1".to_owned() } else { above };
                (format!("\\frac{{{above}}}{{{}}}", all(true, least(true))), Binding::Product)
            }
        })
    }

    fn power(&mut self, _: usize, base: Text, exponent: f64) -> Valued<Text> {
        // A power of a power needs parentheses.
        let is_plain = base.1 == Binding::Power && !base.0.contains('^');
        let base = if is_plain { base.0 } else { format!("\\left({}\\right)", base.0) };
        Ok((format!("{base}^{{{exponent}}}"), Binding::Power))
    }

    fn call(&mut self, _: usize, function: FormulaFunction, of: Text) -> Valued<Text> {
        let text = match function {
            FormulaFunction::SquareRoot => format!("\\sqrt{{{}}}", of.0),
            FormulaFunction::ArcTangent => format!("\\arctan\\left({}\\right)", of.0),
            FormulaFunction::Logarithm => format!("\\ln\\left({}\\right)", of.0),
            _ => format!("\\{}\\left({}\\right)", function.name(), of.0),
        };
        Ok((text, Binding::Power))
    }
}
