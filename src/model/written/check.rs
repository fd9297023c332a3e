//! Checks a system file as a whole: names, dimensions, and what each formula may depend on.

use std::ptr;

use super::definition::{
    COEFFICIENT, SystemDefinition, WrittenDerived, WrittenNormal, WrittenOutput, law_key,
};
use super::dependence::Dependence;
use super::dimensions::TermDimension;
use super::evaluate::Bodies;
use super::formula::{Dimension, Formula, FormulaFault, NONE, WHOLE};
use super::instance::{FaultAt, Instance, with_index};
use crate::model;

/// What a formula may depend on.
#[derive(Clone, Copy, PartialEq)]
enum Allowed {
    Constants,
    /// Positions and the time.
    Positions,
    /// Positions and the time: a formula of a picture. It is not part of the equations.
    InPicture,
    /// Positions and the time, and linearly on rates of change.
    LinearRates,
    /// Anything but accelerations.
    Anything,
    /// Anything, and linearly on accelerations.
    LinearAccelerations,
}

impl Allowed {
    fn refuses(self, found: Dependence) -> Option<(&'static str, &'static str)> {
        let rates = ("a formula with rates of change", "positions, parameters and the time");
        let is_linear = matches!(self, Allowed::LinearAccelerations) && found.accelerations == 1;
        if found.accelerations > 0 && !is_linear {
            return Some((
                "a formula with an acceleration",
                "accelerations (two primes) only in the normal force of a contact, and linear there",
            ));
        }
        match self {
            Allowed::Constants if !found.is_constant() => Some((
                "a formula that changes with the state or the time",
                "parameters and numbers",
            )),
            Allowed::Positions | Allowed::InPicture if found.rates > 0 => Some(rates),
            Allowed::InPicture if found.given_rate => Some(rates),
            Allowed::LinearRates if found.rates == 0 => Some((
                "a sliding speed without a rate of change",
                "rates of change (one prime), as in x' - v_belt",
            )),
            Allowed::LinearRates if found.rates > 1 => Some((
                "a formula that is not linear in the rates of change",
                "a sum of rates of change with factors of positions, parameters and the time",
            )),
            _ => None,
        }
    }
}

/// A formula with what is required of it.
struct CheckedFormula<'d> {
    path: Vec<String>,
    formula: &'d Formula,
    required: Required,
    bodies: Bodies,
}

/// What a formula may depend on, and its dimension.
type Required = (Allowed, Option<Dimension>);

/// `kg m²/s²`
const ENERGY: Dimension = [WHOLE, 2 * WHOLE, -2 * WHOLE];
const SECOND: Dimension = [0, 0, WHOLE];
const LENGTH: Dimension = [0, WHOLE, 0];

fn over(left: Dimension, right: Dimension) -> Dimension {
    [left[0] - right[0], left[1] - right[1], left[2] - right[2]]
}

impl SystemDefinition {
    /// Checks the system with the default numbers of bodies, and finds the dimension of each number in its formulas.
    pub fn check(&mut self) -> Result<(), FaultAt> {
        self.check_names()?;
        self.check_sizes()?;
        // A contact of no bodies has formulas, too.
        let instance = Instance::new(self, |name| self.default_count(name).max(1))?;
        let (found, all, seen) = check_formulas(&instance)?;
        for (formula, numbers) in found {
            let all = || numbers.iter().map(|number| number.unwrap_or(NONE)).collect();
            formula.dimensions.get_or_init(all);
        }
        self.uses_time = all.time;
        self.uses_accelerations = all.accelerations > 0;
        if let Some(motion) = self.motions.iter().find(|motion| !seen.contains(&motion.name)) {
            let allowed = "a motion that an equation or an output contains";
            let fault = FormulaFault::new(0, "a motion without effect", &motion.name, allowed);
            return Err((vec!["motions".to_owned(), motion.name.clone()], fault));
        }
        if let Some(turning) = self.turning.as_ref().filter(|_| !all.time) {
            let allowed = "an angle that an equation contains";
            let fault = FormulaFault::new(0, "an angle without effect", &turning.angle, allowed);
            return Err((vec!["turning".to_owned(), turning.angle.clone()], fault));
        }
        if let Some(period) = self.period.as_ref().filter(|_| !all.time) {
            let allowed = "no period: no formula contains the time t";
            let fault = FormulaFault::new(0, "a period without the time", &period.text, allowed);
            return Err((vec!["period".to_owned()], fault));
        }
        Ok(())
    }

    /// Returns the default of a whole number; 1 for another parameter.
    pub(super) fn default_count(&self, name: &str) -> i64 {
        let parameter = self.parameters.iter().find(|parameter| parameter.name == name);
        parameter.map_or(1, |parameter| parameter.value as i64)
    }
}

/// The dimensions of the numbers in each formula.
type Numbers<'d> = Vec<(&'d Formula, Vec<Option<Dimension>>)>;

/// Checks all formulas; returns the dimensions of their numbers, what the equations depend on, and the names in them.
fn check_formulas<'d>(
    instance: &Instance<'d>,
) -> Result<(Numbers<'d>, Dependence, Vec<String>), FaultAt> {
    let mut found = Numbers::new();
    let (mut terms, mut all, mut seen) = (0, Dependence::default(), Vec::new());
    for used in uses(instance)? {
        let CheckedFormula { path, formula, required: (allowed, dimension), mut bodies } = used;
        let at = |fault: FormulaFault| (path.clone(), fault);
        bodies.terms = terms;
        let (found_here, mut values) = instance.analysed(formula, &mut bodies).map_err(at)?;
        let depends = found_here.depends;
        let contains = |wanted: &str| values.appearing.iter().any(|(name, _)| name == wanted);
        if !instance.definition.motions.is_empty() && contains("t") {
            let allowed = "given motions alone; another force over time is a further motion";
            let problem = "the time beside a motion of a table";
            return Err(at(FormulaFault::new(0, problem, "t", allowed)));
        }
        if let Some(turning) = &instance.definition.turning {
            if contains("t") {
                let allowed = format!("the angle {} alone: a profile gives it", turning.angle);
                let problem = "the time beside a part that turns";
                return Err(at(FormulaFault::new(0, problem, "t", allowed)));
            }
            if allowed != Allowed::Constants && contains(&turning.speed) {
                let allowed = format!("{}', which also follows a speed profile", turning.angle);
                let problem = "the last speed of a part that turns";
                return Err(at(FormulaFault::new(0, problem, &turning.speed, allowed)));
            }
        }
        if let Some((problem, allowed)) = allowed.refuses(depends) {
            return Err(at(FormulaFault::new(0, problem, formula.text.as_str(), allowed)));
        }
        if allowed != Allowed::InPicture {
            all = all.with(depends);
            seen.extend(values.appearing.iter().map(|(name, _)| name.clone()));
        }
        if let Some(wanted) = dimension {
            values.require(0, found_here.measured, wanted).map_err(at)?;
        }
        terms = bodies.terms;
        let known = found.iter_mut().find(|(known, _)| ptr::eq(*known, formula));
        let Some((_, known)) = known else {
            found.push((formula, values.numbers));
            continue;
        };
        for (known, number) in known.iter_mut().zip(values.numbers) {
            if known.is_some() && number.is_some() && *known != number {
                let problem = "a formula with other dimensions for other bodies";
                let allowed = "parameters with units in place of its numbers";
                return Err(at(FormulaFault::new(0, problem, formula.text.as_str(), allowed)));
            }
            *known = known.or(number);
        }
    }
    Ok((found, all, seen))
}

/// Returns all formulas of a system, for each body.
fn uses<'d>(instance: &Instance<'d>) -> Result<Vec<CheckedFormula<'d>>, FaultAt> {
    let definition = instance.definition;
    let path = |keys: &[&str]| keys.iter().map(|key| (*key).to_owned()).collect::<Vec<String>>();
    let unit = |number: usize| instance.coordinate(number).unit.dimension;
    let mut all = Vec::new();
    for member in &instance.coordinates {
        let coordinate = &definition.coordinates[member.of];
        let name = with_index(&coordinate.name, coordinate.index.as_deref());
        let dimension = coordinate.unit.dimension;
        let both = [("start", dimension), ("start_rate", over(dimension, SECOND))];
        for (range, (key, dimension)) in coordinate.start.iter().zip(both) {
            for (end, formula) in range.iter().enumerate() {
                let mut path = path(&["coordinates", &name, key]);
                path.push(format!("[{end}]"));
                let bodies = instance.bound(coordinate.index.as_deref(), member.body);
                let required = (Allowed::Constants, Some(dimension));
                all.push(CheckedFormula { path, formula, required, bodies });
            }
        }
    }
    let mut taken = Vec::new();
    for ([row, column], formula) in &definition.mass {
        let path = path(&["mass", &row.0.text, &column.0.text]);
        let places = instance
            .places([row, column])
            .map_err(|(which, fault)| (path[..2 + which].to_vec(), fault))?;
        for ([row, column], bodies) in places {
            let pair = [row.min(column), row.max(column)];
            if taken.contains(&pair) {
                let allowed = "one entry for each pair of coordinates: the matrix is symmetric";
                let fault = FormulaFault::new(0, "an entry that is given twice", &path[2], allowed);
                return Err((path, fault));
            }
            taken.push(pair);
            let mass = over(over(over(ENERGY, unit(row)), unit(column)), [0, 0, -2 * WHOLE]);
            let (path, required) = (path.clone(), (Allowed::Positions, Some(mass)));
            all.push(CheckedFormula { path, formula, required, bodies });
        }
    }
    let without = |number: &usize| !taken.contains(&[*number; 2]);
    if let Some(number) = (0..instance.coordinates.len()).find(without) {
        let coordinate = instance.coordinate(number);
        let name = with_index(&coordinate.name, coordinate.index.as_deref());
        let (problem, allowed) =
            ("a coordinate without a mass", format!("{name}: {{{name}: ...}}"));
        return Err((path(&["mass"]), FormulaFault::new(0, problem, &name, allowed)));
    }
    for (place, formula) in &definition.force {
        let path = path(&["force", &place.0.text]);
        let places = instance.places([place]).map_err(|(_, fault)| (path.clone(), fault))?;
        for ([number], bodies) in places {
            let required = (Allowed::Anything, Some(over(ENERGY, unit(number))));
            all.push(CheckedFormula { path: path.clone(), formula, required, bodies });
        }
    }
    for number in 0..instance.contacts.len() {
        let speed = instance.speed_dimension(number)?;
        let (contact, bodies) = instance.contact(number);
        let mut add = |key: &str, formula: &'d Formula, allowed: Allowed, dimension: Dimension| {
            let (path, bodies) = (instance.contact_path(number, key), bodies.clone());
            all.push(CheckedFormula {
                path,
                formula,
                required: (allowed, Some(dimension)),
                bodies,
            });
        };
        if let Some(sliding) = &contact.sliding {
            add("sliding", sliding, Allowed::LinearRates, speed);
        }
        let power = over(ENERGY, SECOND);
        match &contact.normal {
            WrittenNormal::Given(force) => {
                add("normal", force, Allowed::LinearAccelerations, over(power, speed));
            }
            WrittenNormal::Gap(gap) => {
                add("gap", gap, Allowed::Positions, [speed[0], speed[1], speed[2] + WHOLE]);
            }
        }
        if let Some(friction) = &contact.friction {
            let key = |name: &str| format!("friction.{}.{name}", friction.law.name());
            add(&key(COEFFICIENT), &friction.coefficient, Allowed::Constants, NONE);
            for (parameter, formula) in friction.law.parameters().iter().zip(&friction.values) {
                let dimension = match parameter.dimension {
                    model::LawDimension::Ratio => NONE,
                    model::LawDimension::SlidingSpeed { .. } => speed,
                    model::LawDimension::Drag => over(over(power, speed), speed),
                };
                add(&key(law_key(parameter)), formula, Allowed::Constants, dimension);
            }
        }
        let [normal, tangential] = &contact.restitution;
        add("restitution", normal, Allowed::Constants, NONE);
        add("tangential_restitution", tangential, Allowed::Constants, NONE);
    }
    for number in 0..instance.outputs.len() {
        let (output, bodies) = instance.output(number);
        let path = path(&["outputs", &with_index(&output.name, output.index.as_deref())]);
        let required = (Allowed::Anything, output.unit.as_ref().map(|unit| unit.dimension));
        all.push(CheckedFormula { path, formula: &output.formula, required, bodies });
    }
    for WrittenDerived { quantity, within, usual } in &definition.derived {
        let WrittenOutput { name, unit, formula, .. } = quantity;
        let mut add = |keys: &[&str], formula: &'d Formula, dimension: Option<Dimension>| {
            let (path, bodies) = (path(keys), instance.bodies.clone());
            let required = (Allowed::Constants, dimension);
            all.push(CheckedFormula { path, formula, required, bodies });
        };
        let given = unit.as_ref().map(|unit| unit.dimension);
        add(&["derived", name], formula, given);
        let fault = |fault| (path(&["derived", name]), fault);
        let found = instance.dimension(formula, instance.bodies.clone()).map_err(fault)?;
        for (key, ends) in [("within", within), ("usual", usual)] {
            for (end, place) in ends.iter().flatten().zip(["[0]", "[1]"]) {
                add(&["derived", name, key, place], end, Some(given.unwrap_or(found)));
            }
        }
    }
    for (view, shape) in
        definition.draw.iter().flat_map(|view| view.shapes.iter().map(move |shape| (view, shape)))
    {
        let name = with_index(&shape.name, shape.index.as_deref());
        let of_shape =
            |keys: &[&str]| path(&[&["draw", &view.name, "shapes", &name], keys].concat());
        // Without a body, a formula is checked as that of the first one.
        let count = shape.index.as_ref().map(|index| instance.bodies.of(index).unwrap_or(0));
        for body in 1..=count.unwrap_or(1) {
            let body = count.map(|_| body);
            let fault = |fault| (of_shape(&["contact"]), fault);
            instance.contact_of(shape, body).map_err(fault)?;
            for (number, formula) in shape.values.iter().enumerate() {
                let keys = shape.keys_of(number);
                let path = of_shape(&keys.iter().map(String::as_str).collect::<Vec<_>>());
                let bodies = instance.bound(shape.index.as_deref(), body);
                let required = (Allowed::InPicture, Some(LENGTH));
                all.push(CheckedFormula { path, formula, required, bodies });
            }
        }
    }
    if let Some(formula) = &definition.period {
        let (bodies, required) = (instance.bodies.clone(), (Allowed::Constants, Some(SECOND)));
        all.push(CheckedFormula { path: path(&["period"]), formula, required, bodies });
    }
    Ok(all)
}

impl Instance<'_> {
    /// Checks all formulas with the numbers of bodies of this system.
    pub fn check(&self) -> Result<(), FaultAt> {
        let (found, ..) = check_formulas(self)?;
        for (path, formula) in uses(self)?.into_iter().map(|used| (used.path, used.formula)) {
            let numbers = found.iter().find(|(known, _)| ptr::eq(*known, formula));
            let mut both = numbers.iter().flat_map(|(_, numbers)| numbers).zip(0..);
            if both.any(|(found, place)| found.is_some_and(|at| at != formula.dimension_of(place)))
            {
                let problem = "a number whose unit the default numbers of bodies do not show";
                let allowed = "a parameter with a unit in its place";
                return Err((path, FormulaFault::new(0, problem, formula.text.as_str(), allowed)));
            }
        }
        Ok(())
    }

    /// Returns the dimension of the sliding speed of a contact, or of the rate of change of its gap.
    pub fn speed_dimension(&self, number: usize) -> Result<Dimension, FaultAt> {
        let (contact, mut bodies) = self.contact(number);
        let (key, formula) = match &contact.sliding {
            Some(sliding) => ("sliding", sliding),
            None => contact.normal.entry(),
        };
        let found = self.analysed(formula, &mut bodies);
        let (found, _) = found.map_err(|fault| (self.contact_path(number, key), fault))?;
        Ok(match (found.measured, key) {
            (TermDimension::Known(dimension), "gap") => over(dimension, SECOND),
            (TermDimension::Known(dimension), _) => dimension,
            _ => NONE,
        })
    }
}
