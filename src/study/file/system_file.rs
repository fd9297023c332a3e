//! The keys of a system file: a mechanical system that its user describes with formulas.

use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;

use super::values::{TableKey, notations};
use crate::study::error::describe_number;

/// A mechanical system: `M q'' = force + contacts`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::study) struct SystemFile {
    /// The name of the system: lower-case letters, digits and `_`.
    pub system: String,
    /// What it is, in a sentence.
    #[serde(default)]
    pub meaning: String,
    /// Parameters by name.
    #[serde(default)]
    pub parameters: IndexMap<String, ParameterEntry>,
    /// Indices that count bodies, each with the parameter that is the number of bodies.
    #[serde(default)]
    pub repeat: IndexMap<String, String>,
    /// Coordinates by name; `x[block]` for a coordinate of each body.
    pub coordinates: IndexMap<String, CoordinateEntry>,
    /// Entries of the mass matrix by row and column: one half; the other half is equal, and what is missing is 0.
    pub mass: IndexMap<String, IndexMap<String, FormulaText>>,
    /// Forces by coordinate, without those of contacts.
    #[serde(default)]
    pub force: IndexMap<String, FormulaText>,
    /// Contacts by name; `belt[block]` for a contact of each body. By default, there are none.
    #[serde(default)]
    pub contacts: IndexMap<String, ContactEntry>,
    /// Quantities that results show besides the coordinates, by name; `load[block]` for one of each body.
    #[serde(default)]
    pub outputs: IndexMap<String, OutputEntry>,
    /// Quantities that follow from the parameters alone, by name, such as a speed limit; `check` shows them.
    #[serde(default)]
    pub derived: IndexMap<String, DerivedEntry>,
    /// Motions that tables give over time, by name.
    #[serde(default)]
    pub motions: IndexMap<String, MotionEntry>,
    /// Pictures for the animation of a run, by name.
    #[serde(default)]
    pub draw: IndexMap<String, ViewEntry>,
    /// The angle of a part that turns, with the parameter that is its speed: `{theta: speed}`.
    #[serde(default)]
    #[schemars(extend("maxProperties" = 1))]
    pub turning: IndexMap<String, String>,
    /// The time after which the equations repeat, if they contain the time `t`.
    pub period: Option<FormulaText>,
}

/// A parameter: its value with a unit, such as `0.3 kg`, or keys.
#[derive(Clone, Debug, JsonSchema)]
pub(in crate::study) struct ParameterEntry(#[schemars(with = "ValueOrKeys")] pub ParameterKeys);

/// The keys of a parameter.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::study) struct ParameterKeys {
    /// The default: a number, or a value with a unit such as `0.3 kg`.
    pub value: FormulaText,
    /// What it is, in a few words.
    #[serde(default)]
    pub meaning: String,
    /// The possible values; by default any.
    pub bound: Option<BoundFile>,
    /// The least value of a whole number; by default 1, or 0 if that is the default.
    pub least: Option<u64>,
    /// The largest value of a whole number, such as a number of bodies.
    pub most: Option<u64>,
}

/// The possible values of a parameter.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub(in crate::study) enum BoundFile {
    /// Above 0.
    Positive,
    /// 0 or more.
    NotNegative,
}

/// An output: its formula, or keys.
#[derive(Clone, Debug, JsonSchema)]
pub(in crate::study) struct OutputEntry(#[schemars(with = "FormulaOrKeys")] pub OutputKeys);

/// The keys of an output.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::study) struct OutputKeys {
    /// Its formula.
    pub value: FormulaText,
    /// Its unit, if its dimension has several, such as `rad/s` beside `1/s`.
    pub unit: Option<String>,
    /// What it is, in a few words.
    #[serde(default)]
    pub meaning: String,
}

/// A quantity of parameters alone: its formula, or keys.
#[derive(Clone, Debug, JsonSchema)]
pub(in crate::study) struct DerivedEntry(#[schemars(with = "FormulaOrDerived")] pub DerivedKeys);

/// The keys of a quantity of parameters alone.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::study) struct DerivedKeys {
    /// Its formula.
    pub value: FormulaText,
    /// Its unit, if its dimension has several, such as `rad/s` beside `1/s`.
    pub unit: Option<String>,
    /// What it is, in a few words.
    #[serde(default)]
    pub meaning: String,
    /// The range `[low, high]` of possible machines; the program refuses others.
    pub within: Option<Ends>,
    /// The range `[low, high]` of usual machines; `check` warns of others.
    pub usual: Option<Ends>,
}

/// A coordinate.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::study) struct CoordinateEntry {
    /// Its unit, such as `m` or `rad`; by default, none.
    pub unit: Option<String>,
    /// Start value, or range `[low, high]` of start values; by default 0.
    pub start: Option<Ends>,
    /// Start value, or range, of its rate of change; by default 0.
    pub start_rate: Option<Ends>,
    /// What results call its rate of change; by default the name with `_rate`.
    pub rate: Option<String>,
    /// Whether it is an angle that may go round and round.
    #[serde(default)]
    pub periodic: bool,
    /// Whether an animation may enlarge it, because it is small beside the machine.
    #[serde(default)]
    pub enlarged: bool,
    /// What it is, in a few words.
    #[serde(default)]
    pub meaning: String,
}

/// A motion that a table gives over time: a cubic spline through its rows.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::study) struct MotionEntry {
    /// Its unit, such as `m` or `rad`; by default, none.
    pub unit: Option<String>,
    /// A table with the columns `time [s]` and the name of the motion with its unit. Times grow from 0.
    pub table: TableKey,
    /// What it is, in a few words.
    #[serde(default)]
    #[expect(dead_code, reason = "`check` prints it from the keys of the file")]
    pub meaning: String,
}

/// A picture of an animation.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::study) struct ViewEntry {
    /// Whether the animation can turn it with the part that turns.
    #[serde(default)]
    pub turns: bool,
    /// Shapes by name; `ball[ball]` for a shape of each body. Later shapes cover earlier ones.
    #[schemars(extend("minProperties" = 1))]
    pub shapes: IndexMap<String, ShapeEntry>,
}

/// A shape: one of `circle`, `line`, `polygon`, `spring` and `mark`. A point `[x, y]` has two formulas of positions.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::study) struct ShapeEntry {
    /// The centre of a circle.
    pub circle: Option<PointEntry>,
    /// The radius of a circle.
    pub radius: Option<FormulaText>,
    /// The points of a line.
    pub line: Option<Vec<PointEntry>>,
    /// The corners of an area.
    pub polygon: Option<Vec<PointEntry>>,
    /// The ends of a spring.
    #[schemars(extend("minItems" = 2, "maxItems" = 2))]
    pub spring: Option<Vec<PointEntry>>,
    /// The place of a dot that shows whether its contact is closed.
    pub mark: Option<PointEntry>,
    /// The contact whose stick and slip the shape shows, such as `race[ball]`.
    pub contact: Option<String>,
}

/// The coordinates `[x, y]` of a point.
#[derive(Clone, Debug, JsonSchema)]
pub(in crate::study) struct PointEntry(
    #[schemars(with = "[NumberOrText; 2]")] pub Vec<FormulaText>,
);

notations! {
    PointEntry: "a point [x, y]",
    list(Vec<FormulaText>) => PointEntry,
}

/// A contact with a given normal force, or with a gap.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::study) struct ContactEntry {
    /// The distance of the bodies, which does not become negative.
    pub gap: Option<FormulaText>,
    /// The force that presses the bodies together, for a contact that does not open.
    pub normal: Option<FormulaText>,
    /// The sliding speed; x' is the rate of change of x.
    pub sliding: Option<FormulaText>,
    /// The law of friction with its parameters, or `study` for that of `model.friction`; by default, no friction.
    pub friction: Option<FrictionEntry>,
    /// Speed of separation over speed of approach in an impact, 0 to 1; by default 0.
    pub restitution: Option<FormulaText>,
    /// Sliding speed after an impact without slip over that before it, with the opposite sign, 0 to 1; by default 0.
    pub tangential_restitution: Option<FormulaText>,
}

/// The laws of friction with their parameters.
type Laws = IndexMap<String, IndexMap<String, FormulaText>>;

/// A law of friction with its parameters; none for that of the study.
#[derive(Clone, Debug, JsonSchema)]
pub(in crate::study) struct FrictionEntry(#[schemars(with = "StudyOrLaw")] pub Option<Laws>);

notations! {
    FrictionEntry: "a law such as {coulomb: {coefficient: 0.3}}, or `study`",
    text => |text: &str| (text == "study").then_some(FrictionEntry(None)),
    map(Laws) => |laws| FrictionEntry(Some(laws)),
}

/// A formula, a number, or a value with a unit.
#[derive(Clone, Debug, Default, JsonSchema, PartialEq)]
pub(in crate::study) struct FormulaText(#[schemars(with = "NumberOrText")] pub String);

notations! {
    FormulaText: "a formula or a number",
    number => |number: f64| Some(FormulaText(describe_number(number))),
    text => |text: &str| Some(FormulaText(text.to_owned())),
}

/// One value, or the two ends of a range.
#[derive(Clone, Debug, JsonSchema)]
pub(in crate::study) struct Ends(#[schemars(with = "OneOrTwo")] pub Vec<FormulaText>);

notations! {
    Ends: "a value, or two values [low, high]",
    number => |number: f64| Some(Ends(vec![FormulaText(describe_number(number))])),
    text => |text: &str| Some(Ends(vec![FormulaText(text.to_owned())])),
    list(Vec<FormulaText>) => Ends,
}

notations! {
    ParameterEntry: "a value such as 0.3 kg, or keys and values",
    number => |number: f64| Some(ParameterEntry::of(describe_number(number))),
    text => |text: &str| Some(ParameterEntry::of(text.to_owned())),
    map(ParameterKeys) => ParameterEntry,
}

notations! {
    OutputEntry: "a formula, or keys and values",
    number => |number: f64| Some(OutputEntry::of(describe_number(number))),
    text => |text: &str| Some(OutputEntry::of(text.to_owned())),
    map(OutputKeys) => OutputEntry,
}

notations! {
    DerivedEntry: "a formula, or keys and values",
    number => |number: f64| Some(DerivedEntry::of(describe_number(number))),
    text => |text: &str| Some(DerivedEntry::of(text.to_owned())),
    map(DerivedKeys) => DerivedEntry,
}

impl DerivedEntry {
    fn of(formula: String) -> Self {
        DerivedEntry(DerivedKeys { value: FormulaText(formula), ..DerivedKeys::default() })
    }
}

impl OutputEntry {
    fn of(formula: String) -> Self {
        OutputEntry(OutputKeys { value: FormulaText(formula), ..OutputKeys::default() })
    }
}

impl ParameterEntry {
    fn of(value: String) -> Self {
        ParameterEntry(ParameterKeys { value: FormulaText(value), ..ParameterKeys::default() })
    }
}

/// The notations of a formula, of a range and of a parameter, for the JSON Schema.
#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only the schema of these types is used")]
enum NumberOrText {
    Number(f64),
    Text(String),
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only the schema of these types is used")]
enum OneOrTwo {
    One(NumberOrText),
    Two([NumberOrText; 2]),
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only the schema of these types is used")]
enum ValueOrKeys {
    Value(NumberOrText),
    Keys(ParameterKeys),
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only the schema of these types is used")]
enum FormulaOrKeys {
    Formula(NumberOrText),
    Keys(OutputKeys),
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only the schema of these types is used")]
enum FormulaOrDerived {
    Formula(NumberOrText),
    Keys(DerivedKeys),
}

#[derive(JsonSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only the schema of these types is used")]
enum StudyOrLaw {
    Study(OfStudy),
    Law(Laws),
}

#[derive(JsonSchema)]
#[serde(rename_all = "snake_case")]
#[expect(dead_code, reason = "only the schema of these types is used")]
enum OfStudy {
    Study,
}
