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
    allowed: Allowed,
    dimension: Option<Dimension>,
    bodies: Bodies,
}

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
        let (found, all, seen) = {
            let definition: &SystemDefinition = self;
            // A contact of no bodies has formulas, too.
            let instance = Instance::new(definition, |name| definition.default_count(name).max(1))?;
            check_formulas(&instance)?
        };
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
        for formula in self.formulas_mut() {
            if let Some((_, numbers)) = found.iter().find(|(known, _)| ptr::eq(*known, formula)) {
                formula.numbers = numbers.iter().map(|number| number.unwrap_or(NONE)).collect();
            }
        }
        Ok(())
    }

    /// Returns the default of a whole number; 1 for another parameter.
    pub(super) fn default_count(&self, name: &str) -> i64 {
        let parameter = self.parameters.iter().find(|parameter| parameter.name == name);
        parameter.map_or(1, |parameter| parameter.value as i64)
    }

    fn formulas_mut(&mut self) -> impl Iterator<Item = &mut Formula> {
        let mass = self.mass.iter_mut().map(|(_, formula)| formula);
        let force = self.force.iter_mut().map(|(_, formula)| formula);
        let starts = self.coordinates.iter_mut().flat_map(|q| q.start.iter_mut().flatten());
        let contacts = self.contacts.iter_mut().flat_map(|contact| {
            let normal = match &mut contact.normal {
                WrittenNormal::Given(force) => force,
                WrittenNormal::Gap(gap) => gap,
            };
            let friction = contact.friction.iter_mut();
            let friction =
                friction.flat_map(|law| [&mut law.coefficient].into_iter().chain(&mut law.values));
            contact
                .sliding
                .iter_mut()
                .chain([normal])
                .chain(friction)
                .chain(&mut contact.restitution)
        });
        let outputs = self.outputs.iter_mut().map(|output| &mut output.formula);
        let derived = self.derived.iter_mut().flat_map(|derived| {
            let ends = derived.within.iter_mut().chain(&mut derived.usual).flatten();
            [&mut derived.quantity.formula].into_iter().chain(ends)
        });
        let drawn = self.draw.iter_mut().flat_map(|view| &mut view.shapes);
        let drawn = drawn.flat_map(|shape| &mut shape.values);
        let results = outputs.chain(derived).chain(drawn);
        mass.chain(force).chain(starts).chain(contacts).chain(results).chain(&mut self.period)
    }
}

/// The dimensions of the numbers in each formula.
type Numbers = Vec<(*const Formula, Vec<Option<Dimension>>)>;

/// Checks all formulas; returns the dimensions of their numbers, what the equations depend on, and the names in them.
fn check_formulas(instance: &Instance<'_>) -> Result<(Numbers, Dependence, Vec<String>), FaultAt> {
    let mut found = Numbers::new();
    let (mut terms, mut all, mut seen) = (0, Dependence::default(), Vec::new());
    for used in uses(instance)? {
        let CheckedFormula { path, formula, allowed, dimension, mut bodies } = used;
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
        if let Some(turning) = &instance.definition.turning
            && contains("t")
        {
            let allowed = format!("the angle {} alone: a profile gives it", turning.angle);
            let problem = "the time beside a part that turns";
            return Err(at(FormulaFault::new(0, problem, "t", allowed)));
        }
        if let Some(turning) = &instance.definition.turning
            && allowed != Allowed::Constants
            && contains(&turning.speed)
        {
            let allowed = format!("{}', which also follows a speed profile", turning.angle);
            let problem = "the last speed of a part that turns";
            return Err(at(FormulaFault::new(0, problem, &turning.speed, allowed)));
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
            found.push((ptr::from_ref(formula), values.numbers));
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
    let unit =
        |number: usize| definition.coordinates[instance.coordinates[number].of].unit.dimension;
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
                let (allowed, dimension) = (Allowed::Constants, Some(dimension));
                all.push(CheckedFormula { path, formula, allowed, dimension, bodies });
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
            let dimension =
                Some(over(over(over(ENERGY, unit(row)), unit(column)), [0, 0, -2 * WHOLE]));
            let path = path.clone();
            all.push(CheckedFormula {
                path,
                formula,
                allowed: Allowed::Positions,
                dimension,
                bodies,
            });
        }
    }
    let without = |number: &usize| !taken.contains(&[*number; 2]);
    if let Some(number) = (0..instance.coordinates.len()).find(without) {
        let coordinate = &definition.coordinates[instance.coordinates[number].of];
        let name = with_index(&coordinate.name, coordinate.index.as_deref());
        let (problem, allowed) =
            ("a coordinate without a mass", format!("{name}: {{{name}: ...}}"));
        return Err((path(&["mass"]), FormulaFault::new(0, problem, &name, allowed)));
    }
    for (place, formula) in &definition.force {
        let path = path(&["force", &place.0.text]);
        let places = instance.places([place]).map_err(|(_, fault)| (path.clone(), fault))?;
        for ([number], bodies) in places {
            let dimension = Some(over(ENERGY, unit(number)));
            let path = path.clone();
            all.push(CheckedFormula {
                path,
                formula,
                allowed: Allowed::Anything,
                dimension,
                bodies,
            });
        }
    }
    for number in 0..instance.contacts.len() {
        let speed = instance.speed_dimension(number)?;
        let (contact, bodies) = instance.contact(number);
        let mut add =
            |key: &str, formula: &'d Formula, allowed: Allowed, dimension: Option<Dimension>| {
                let (path, bodies) = (instance.contact_path(number, key), bodies.clone());
                all.push(CheckedFormula { path, formula, allowed, dimension, bodies });
            };
        if let Some(sliding) = &contact.sliding {
            add("sliding", sliding, Allowed::LinearRates, Some(speed));
        }
        let power = over(ENERGY, SECOND);
        match &contact.normal {
            WrittenNormal::Given(force) => {
                add("normal", force, Allowed::LinearAccelerations, Some(over(power, speed)));
            }
            WrittenNormal::Gap(gap) => {
                let length = [speed[0], speed[1], speed[2] + WHOLE];
                add("gap", gap, Allowed::Positions, Some(length));
            }
        }
        if let Some(friction) = &contact.friction {
            let key = |name: &str| format!("friction.{}.{name}", friction.law.name());
            add(&key(COEFFICIENT), &friction.coefficient, Allowed::Constants, Some(NONE));
            for (parameter, formula) in friction.law.parameters().iter().zip(&friction.values) {
                let dimension = match parameter.dimension {
                    model::LawDimension::Ratio => NONE,
                    model::LawDimension::SlidingSpeed { .. } => speed,
                    model::LawDimension::Drag => over(over(power, speed), speed),
                };
                add(&key(law_key(parameter)), formula, Allowed::Constants, Some(dimension));
            }
        }
        for (key, formula) in
            ["restitution", "tangential_restitution"].iter().zip(&contact.restitution)
        {
            add(key, formula, Allowed::Constants, Some(NONE));
        }
    }
    for number in 0..instance.outputs.len() {
        let (output, bodies) = instance.output(number);
        let path = path(&["outputs", &with_index(&output.name, output.index.as_deref())]);
        let (allowed, formula) = (Allowed::Anything, &output.formula);
        let dimension = output.unit.as_ref().map(|unit| unit.dimension);
        all.push(CheckedFormula { path, formula, allowed, dimension, bodies });
    }
    for WrittenDerived { quantity, within, usual } in &definition.derived {
        let WrittenOutput { name, unit, formula, .. } = quantity;
        let mut add = |keys: &[&str], formula: &'d Formula, dimension: Option<Dimension>| {
            let (path, bodies) = (path(keys), instance.bodies.clone());
            all.push(CheckedFormula {
                path,
                formula,
                allowed: Allowed::Constants,
                dimension,
                bodies,
            });
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
                let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
                all.push(CheckedFormula {
                    path: of_shape(&keys),
                    formula,
                    allowed: Allowed::InPicture,
                    dimension: Some(LENGTH),
                    bodies: instance.bound(shape.index.as_deref(), body),
                });
            }
        }
    }
    if let Some(formula) = &definition.period {
        let (allowed, bodies) = (Allowed::Constants, instance.bodies.clone());
        all.push(CheckedFormula {
            path: path(&["period"]),
            formula,
            allowed,
            dimension: Some(SECOND),
            bodies,
        });
    }
    Ok(all)
}

impl Instance<'_> {
    /// Checks all formulas with the numbers of bodies of this system.
    pub fn check(&self) -> Result<(), FaultAt> {
        let (found, ..) = check_formulas(self)?;
        for (path, formula) in uses(self)?.into_iter().map(|used| (used.path, used.formula)) {
            let numbers = found.iter().find(|(known, _)| ptr::eq(*known, formula));
            let mut both = numbers.iter().flat_map(|(_, numbers)| numbers).zip(&formula.numbers);
            if both.any(|(found, known)| found.is_some_and(|found| found != *known)) {
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
