//! The contents of a figure before it is drawn: panels with axes, and marks at coordinates.
//!
//! Rust code builds figures from tables. The page's script draws them from their JSON, in which long columns are packed, and
//! the Python package draws the same JSON with matplotlib for print. Tests check marks and coordinates, not pixels.

use serde::{Serialize, Serializer};

use super::packed;
use crate::classification::Label;

/// A figure: one or more panels with their texts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Short stable identifier for file names and links, as `time-to-rest`.
    pub id: String,
    /// Title, one line.
    pub title: String,
    /// How to read the figure, and what it omits.
    #[serde(skip)]
    pub caption: String,
    /// Text alternative for readers who do not see the figure.
    pub alternative: String,
    /// Panels in reading order.
    pub panels: Vec<Panel>,
}

/// A figure with its caption, which the page shows apart from the figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PrintedFigure {
    /// How to read the figure, and what it omits.
    pub caption: String,
    /// The figure.
    #[serde(flatten)]
    pub figure: Figure,
}

/// A pair of axes and the layers between them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Panel {
    /// The point; empty if the figure's title names it.
    pub title: String,
    /// The part of the data; empty if there is only one.
    pub part: String,
    /// The abscissa.
    pub x: Axis,
    /// The ordinate.
    pub y: Axis,
    /// Meaning of the colours of cells and rasters.
    pub scale: Option<ColourScale>,
    /// Layers from bottom to top. Layers with equal names share a legend entry.
    pub layers: Vec<Layer>,
}

/// An axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// Quantity, as `speed`.
    pub name: String,
    /// Unit, as `rad/s`; empty for a dimensionless number.
    pub unit: String,
    /// The ends of the axis; chosen from the marks if `None`.
    pub range: Option<[f64; 2]>,
    /// The scale of the axis.
    #[serde(flatten)]
    pub kind: AxisKind,
}

/// The scale of an axis.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case", tag = "kind", content = "names")]
pub enum AxisKind {
    /// Linear.
    Linear,
    /// Logarithmic; only positive values.
    Logarithmic,
    /// Linear from 0 to 2π, with ticks at multiples of π/2.
    Angle,
    /// Names at 0, 1, 2 and so on.
    Names(Vec<String>),
}

/// Meaning of the colours of cells and rasters: a sequence from light to dark.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColourScale {
    /// Quantity with its unit, as `amplitude [µm]`.
    pub name: String,
    /// The values at the two ends.
    pub range: [f64; 2],
}

/// Marks of one kind and meaning.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Layer {
    /// Legend entry; empty for none.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// The marks.
    #[serde(flatten)]
    pub mark: Mark,
}

/// A colour by its meaning; the page defines its value for the dark and the light theme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Colour {
    /// The colour of text.
    Ink,
    /// Weaker than text, for auxiliary lines.
    Faint,
    /// One of eight colours that colour-blind readers can distinguish; larger indices repeat them.
    Series(usize),
    /// By value, from the panel's scale.
    Scale,
    /// Runs with a label.
    #[serde(untagged, serialize_with = "name_of_label")]
    Label(Label),
}

fn name_of_label<S: Serializer>(label: &Label, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(label.name())
}

/// The symbol of a dot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Symbol {
    /// A small filled disc; a hundred thousand of them show a density.
    Dot,
    /// A larger filled disc.
    Disc,
    /// An open circle, for unstable equilibria.
    Circle,
    /// A star, for stable equilibria.
    Star,
    /// A cross.
    Cross,
    /// A filled diamond.
    Diamond,
    /// A filled triangle.
    Triangle,
    /// A filled square.
    Square,
}

/// Marks at coordinates of the panel. All lists of one mark have the same length.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "mark")]
pub enum Mark {
    /// A line through points, in order; broken at a point that is not finite.
    Line {
        /// The points.
        #[serde(serialize_with = "packed::pairs")]
        points: Vec<[f64; 2]>,
        /// Whether it is dashed.
        dashed: bool,
    },
    /// A line that stays at a value until the next point.
    Steps {
        /// The points.
        #[serde(serialize_with = "packed::pairs")]
        points: Vec<[f64; 2]>,
    },
    /// The area between two lines with the same abscissas.
    Band {
        /// Abscissas.
        #[serde(serialize_with = "packed::numbers")]
        x: Vec<f64>,
        /// The lower line.
        #[serde(serialize_with = "packed::numbers")]
        low: Vec<f64>,
        /// The upper line.
        #[serde(serialize_with = "packed::numbers")]
        high: Vec<f64>,
        /// Whether both lines stay at a value until the next point.
        steps: bool,
    },
    /// Vertical bars from low to high: intervals.
    Intervals {
        /// Abscissas.
        #[serde(serialize_with = "packed::numbers")]
        x: Vec<f64>,
        /// Lower ends.
        #[serde(serialize_with = "packed::numbers")]
        low: Vec<f64>,
        /// Upper ends.
        #[serde(serialize_with = "packed::numbers")]
        high: Vec<f64>,
    },
    /// Dots.
    Dots {
        /// Symbol.
        symbol: Symbol,
        /// Abscissas.
        #[serde(serialize_with = "packed::coordinates")]
        x: Vec<f64>,
        /// Ordinates.
        #[serde(serialize_with = "packed::coordinates")]
        y: Vec<f64>,
        /// Data of each dot.
        tooltips: Tooltips,
    },
    /// Values on a regular grid over the whole panel.
    Raster {
        /// Number of cells along the abscissa and along the ordinate.
        size: [usize; 2],
        /// A value for each cell, row by row from the lower edge; NaN leaves a cell open.
        #[serde(serialize_with = "packed::levels")]
        values: Vec<f64>,
    },
    /// Vertical bars from 0.
    Bars {
        /// Abscissas of the centres.
        #[serde(serialize_with = "packed::numbers")]
        x: Vec<f64>,
        /// Ordinates of the ends.
        #[serde(serialize_with = "packed::numbers")]
        y: Vec<f64>,
        /// Width of each bar on the abscissa.
        width: f64,
        /// Data of each bar.
        tooltips: Tooltips,
    },
    /// Rectangles with a value each for the colour scale.
    Cells {
        /// Left, right, lower and upper edge of each.
        #[serde(serialize_with = "packed::edges")]
        edges: Vec<[f64; 4]>,
        /// The values; NaN leaves a cell open.
        #[serde(serialize_with = "packed::numbers")]
        values: Vec<f64>,
        /// Data of each cell.
        tooltips: Tooltips,
    },
    /// A line across the panel.
    Rule {
        /// Whether the line is vertical, at an abscissa.
        upright: bool,
        /// Coordinate.
        at: f64,
        /// Text at the line.
        label: String,
    },
}

/// Data of each dot: the number of its run, if it is one, and named values.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tooltips {
    /// Run numbers, for `stickslip replay`; empty if the dots are not runs.
    #[serde(serialize_with = "packed::whole_numbers")]
    pub run_ids: Vec<u64>,
    /// Further data, column by column.
    pub columns: Vec<TooltipColumn>,
}

/// A column of data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TooltipColumn {
    /// Name with unit, as `amplitude [µm]`.
    pub name: String,
    /// A value for each dot.
    #[serde(flatten)]
    pub values: TooltipValues,
}

/// Returns a linear axis with its quantity and unit.
pub fn axis(name: &str, unit: &str) -> Axis {
    Axis { name: name.to_owned(), unit: unit.to_owned(), range: None, kind: AxisKind::Linear }
}

/// Returns an axis with names at 0, 1, 2 and so on.
pub fn axis_of_names(names: Vec<String>, axis: Axis) -> Axis {
    let range = Some([-0.5, names.len() as f64 - 0.5]);
    Axis { range, kind: AxisKind::Names(names), ..axis }
}

impl Figure {
    /// Returns a figure; `None` without panels.
    pub fn new(
        id: &str,
        title: impl Into<String>,
        caption: impl Into<String>,
        alternative: String,
        panels: Vec<Panel>,
    ) -> Option<Self> {
        let (id, title, caption) = (id.to_owned(), title.into(), caption.into());
        (!panels.is_empty()).then_some(Figure { id, title, caption, alternative, panels })
    }
}

impl Panel {
    /// Returns a panel without titles and colour scale.
    pub fn new(x: Axis, y: Axis, layers: Vec<Layer>) -> Self {
        Panel { title: String::new(), part: String::new(), x, y, scale: None, layers }
    }
}

impl Layer {
    /// Returns a layer.
    pub fn new(name: &str, colour: Colour, mark: Mark) -> Self {
        Layer { name: name.to_owned(), colour, mark }
    }

    /// Returns the number of dots.
    pub fn dots(&self) -> usize {
        match &self.mark {
            Mark::Dots { x, .. } => x.len(),
            _ => 0,
        }
    }
}

impl Mark {
    /// Returns dots at these places.
    pub fn dots(symbol: Symbol, places: &[[f64; 2]], tooltips: Tooltips) -> Self {
        let [x, y] = [0, 1].map(|axis| places.iter().map(|place| place[axis]).collect());
        Mark::Dots { symbol, x, y, tooltips }
    }
}

impl Tooltips {
    /// Returns the data of dots that are not runs: named columns of numbers.
    pub fn numbers<const N: usize>(columns: [(&str, Vec<f64>); N]) -> Self {
        let column = |(name, values): (&str, Vec<f64>)| TooltipColumn {
            name: name.to_owned(),
            values: TooltipValues::Numbers(values),
        };
        Tooltips { run_ids: Vec::new(), columns: columns.map(column).into() }
    }
}

/// Values of a column.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TooltipValues {
    /// Numbers; NaN if there is none.
    #[serde(rename = "values", serialize_with = "packed::numbers")]
    Numbers(Vec<f64>),
    /// Words.
    Words(Vec<String>),
}
