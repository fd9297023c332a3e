//! A mechanical system as its file describes it.

use super::formula::{Dimension, Formula};
use crate::model::{Bound, DrawnForm, GivenMotion, Law, LawParameter};

/// A mechanical system with formulas for its mass matrix, its forces and its contacts.
#[derive(Clone, Debug, PartialEq)]
pub struct SystemDefinition {
    /// The name, in lower-case letters, digits and `_`.
    pub name: String,
    /// What it is, in a sentence.
    pub meaning: String,
    /// The parameters, in the order of the file.
    pub parameters: Vec<WrittenParameter>,
    /// The indices that count bodies, each with the whole number among the parameters that is the number of bodies.
    pub repeat: Vec<(String, String)>,
    /// The coordinates, in the order of the file.
    pub coordinates: Vec<WrittenCoordinate>,
    /// The entries of the mass matrix; the matrix is symmetric, and missing entries are 0.
    pub mass: Vec<([IndexedName; 2], Formula)>,
    /// The forces; missing ones are 0.
    pub force: Vec<(IndexedName, Formula)>,
    /// The contacts.
    pub contacts: Vec<WrittenContact>,
    /// What results show besides the coordinates.
    pub outputs: Vec<WrittenOutput>,
    /// Quantities that follow from the parameters alone.
    pub derived: Vec<WrittenDerived>,
    /// Motions that tables give over time.
    pub motions: Vec<WrittenMotion>,
    /// The pictures for an animation.
    pub draw: Vec<WrittenView>,
    /// The angle of a part that turns at a given speed.
    pub turning: Option<WrittenTurning>,
    /// The time after which the equations repeat; the time of a turn if it is not given.
    pub period: Option<Formula>,
    /// Whether a formula contains the time; [`SystemDefinition::check`] finds this.
    pub uses_time: bool,
    /// Whether a normal force contains an acceleration; [`SystemDefinition::check`] finds this.
    pub uses_accelerations: bool,
    /// The file as plain values, from which it can be read again.
    pub source: serde_json::Value,
}

/// A unit of a system file.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenUnit {
    /// The SI unit, such as `N s/m`; `1` without a dimension.
    pub si: String,
    /// Its dimension.
    pub dimension: Dimension,
}

/// A parameter of a system.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenParameter {
    /// The name in formulas.
    pub name: String,
    /// Its unit.
    pub unit: WrittenUnit,
    /// The default, in the SI unit.
    pub value: f64,
    /// What it is, in a few words.
    pub meaning: String,
    /// The possible values.
    pub bound: Bound,
    /// The least and the largest value of a whole number, which is the same for all runs of a study.
    pub counts: Option<[usize; 2]>,
}

/// A coordinate, with its start range.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenCoordinate {
    /// The name in formulas.
    pub name: String,
    /// The index that counts the bodies with this coordinate.
    pub index: Option<String>,
    /// Its unit.
    pub unit: WrittenUnit,
    /// What results call its rate of change.
    pub rate: String,
    /// Whether it is an angle with a period of one turn.
    pub periodic: bool,
    /// Whether an animation may enlarge it.
    pub enlarged: bool,
    /// What it is, in a few words.
    pub meaning: String,
    /// The default ranges of its start value and of its rate of change.
    pub start: [[Formula; 2]; 2],
}

/// An angle that turns at a given speed, which a study may change in time.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenTurning {
    /// The name of the angle in formulas.
    pub angle: String,
    /// The parameter that is the speed, the last one of a profile.
    pub speed: String,
}

/// A motion that a table gives over time.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenMotion {
    /// The name in formulas.
    pub name: String,
    /// Its unit.
    pub unit: WrittenUnit,
    /// The values over time, in SI units.
    pub motion: GivenMotion,
}

/// A name with the index of a body, such as `x[block + 1]`.
#[derive(Clone, Debug, PartialEq)]
pub struct IndexedName(pub Formula);

/// A quantity that results show.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenOutput {
    /// The name.
    pub name: String,
    /// The index that counts the bodies with this quantity.
    pub index: Option<String>,
    /// Its unit; by default, that of its dimension.
    pub unit: Option<WrittenUnit>,
    /// What it is, in a few words.
    pub meaning: String,
    /// Its value.
    pub formula: Formula,
}

/// A quantity that follows from the parameters alone.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenDerived {
    /// The quantity, without an index.
    pub quantity: WrittenOutput,
    /// The range of possible machines.
    pub within: Option<[Formula; 2]>,
    /// The range of usual machines.
    pub usual: Option<[Formula; 2]>,
}

/// A picture of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenView {
    /// The name.
    pub name: String,
    /// Whether the animation can turn it with the part that turns.
    pub turns: bool,
    /// The shapes; later ones cover earlier ones.
    pub shapes: Vec<WrittenShape>,
}

/// A shape of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenShape {
    /// The name.
    pub name: String,
    /// The index that counts the bodies with this shape.
    pub index: Option<String>,
    /// Its form.
    pub form: DrawnForm,
    /// The coordinates of its points in turn, and the radius of a circle.
    pub values: Vec<Formula>,
    /// The contact whose phase it shows.
    pub contact: Option<IndexedName>,
}

/// A contact.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenContact {
    /// The name.
    pub name: String,
    /// The index that counts the bodies with this contact.
    pub index: Option<String>,
    /// The sliding speed; none without friction.
    pub sliding: Option<Formula>,
    /// The force that presses the bodies together.
    pub normal: WrittenNormal,
    /// The law of friction; none without friction, and for the law of the study.
    pub friction: Option<WrittenFriction>,
    /// Whether the study gives the law of friction, with the parameter `friction_coefficient`.
    pub has_law_of_study: bool,
    /// The coefficients of restitution, in the normal and in the tangential direction.
    pub restitution: [Formula; 2],
}

/// The normal force of a contact.
#[derive(Clone, Debug, PartialEq)]
pub enum WrittenNormal {
    /// It is given.
    Given(Formula),
    /// It keeps this distance from becoming negative.
    Gap(Formula),
}

impl WrittenShape {
    /// Returns the keys, below those of the shape, of one of its values.
    pub fn keys_of(&self, value: usize) -> Vec<String> {
        let form = self.form.name().to_owned();
        let [point, axis] = [value / 2, value % 2].map(|place| format!("[{place}]"));
        match self.form {
            DrawnForm::Circle if value == 2 => vec!["radius".to_owned()],
            DrawnForm::Circle | DrawnForm::Mark => vec![form, axis],
            DrawnForm::Line | DrawnForm::Polygon | DrawnForm::Spring => vec![form, point, axis],
        }
    }
}

impl SystemDefinition {
    /// Returns the place of the parameter that is the speed of the part that turns.
    pub(super) fn speed_place(&self) -> Option<usize> {
        let turning = self.turning.as_ref()?;
        self.parameters.iter().position(|parameter| parameter.name == turning.speed)
    }

    /// Returns whether the study gives the law of friction of a contact.
    pub fn has_law_of_study(&self) -> bool {
        self.contacts.iter().any(|contact| contact.has_law_of_study)
    }
}

impl WrittenNormal {
    /// Returns the key in the file, and the formula.
    pub fn entry(&self) -> (&'static str, &Formula) {
        match self {
            WrittenNormal::Given(force) => ("normal", force),
            WrittenNormal::Gap(gap) => ("gap", gap),
        }
    }
}

/// A law of friction with formulas for its coefficient and its parameters.
#[derive(Clone, Debug)]
pub struct WrittenFriction {
    /// The law.
    pub law: &'static dyn Law,
    /// The (kinetic) coefficient; 0 for a law without it.
    pub coefficient: Formula,
    /// The other parameters, in the order of the law.
    pub values: Vec<Formula>,
}

impl PartialEq for WrittenFriction {
    fn eq(&self, other: &Self) -> bool {
        (self.law.name(), &self.coefficient, &self.values)
            == (other.law.name(), &other.coefficient, &other.values)
    }
}

/// The key of the friction coefficient in a system file.
pub const COEFFICIENT: &str = "coefficient";

/// Returns the key of a parameter of a law in a system file.
pub fn law_key(parameter: &LawParameter) -> &'static str {
    match parameter.name {
        "static_friction_coefficient" => "static_coefficient",
        "viscous_coefficient_n_s_m" => "viscous_coefficient",
        name => name,
    }
}
