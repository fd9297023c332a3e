//! The contents of a figure before it is drawn: panels with axes, and marks at coordinates.
//!
//! Rust code builds figures from tables, and the page's script draws them. Tests check marks and coordinates, not
//! pixels.

use serde::Serialize;

/// A figure: one or more panels with their texts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Short stable identifier for file names and links, as `time-to-rest`.
    pub id: String,
    /// Title, one line.
    pub title: String,
    /// How to read the figure, and what it omits.
    pub caption: String,
    /// Text alternative for readers who do not see the figure.
    pub alternative: String,
    /// Panels in reading order.
    pub panels: Vec<Panel>,
    /// Whether the page shows one panel at a time, selected by its title.
    pub one_at_a_time: bool,
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
    pub kind: AxisKind,
}

/// The scale of an axis.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
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
    /// Runs that ended in equilibrium.
    Equilibrium,
    /// Runs that ended in a limit cycle.
    LimitCycle,
    /// Runs of irregular motion.
    Irregular,
    /// Undecided runs.
    Undecided,
    /// Runs that failed.
    Failed,
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
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// A line through points, in order; broken at a point that is not finite.
    Line {
        /// The points.
        points: Vec<[f64; 2]>,
        /// Whether it is dashed.
        dashed: bool,
    },
    /// A line that stays at a value until the next point.
    Steps {
        /// The points.
        points: Vec<[f64; 2]>,
    },
    /// The area between two lines with the same abscissas.
    Band {
        /// Abscissas.
        x: Vec<f64>,
        /// The lower line.
        low: Vec<f64>,
        /// The upper line.
        high: Vec<f64>,
        /// Whether both lines stay at a value until the next point.
        steps: bool,
    },
    /// Vertical bars from low to high: intervals.
    Intervals {
        /// Abscissas.
        x: Vec<f64>,
        /// Lower ends.
        low: Vec<f64>,
        /// Upper ends.
        high: Vec<f64>,
    },
    /// Columns from a base to a top, with a width in units of the abscissa.
    Bars {
        /// Abscissas of their centres.
        x: Vec<f64>,
        /// Lower ends.
        base: Vec<f64>,
        /// Upper ends.
        top: Vec<f64>,
        /// Their width.
        width: f64,
    },
    /// Dots.
    Dots {
        /// Symbol.
        symbol: Symbol,
        /// Abscissas.
        x: Vec<f64>,
        /// Ordinates.
        y: Vec<f64>,
        /// Data of each dot.
        tooltips: Tooltips,
    },
    /// Values on a regular grid over the whole panel.
    Raster {
        /// Number of cells along the abscissa and along the ordinate.
        size: [usize; 2],
        /// A value for each cell, row by row from the lower edge; NaN leaves a cell open.
        values: Vec<f64>,
    },
    /// Rectangles with a value each for the colour scale.
    Cells {
        /// Left, right, lower and upper edge of each.
        edges: Vec<[f64; 4]>,
        /// The values; `None` leaves a cell open.
        values: Vec<Option<f64>>,
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
    pub values: TooltipValues,
}

/// Values of a column.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TooltipValues {
    /// Numbers; NaN if there is none.
    Numbers(Vec<f64>),
    /// Words.
    Words(Vec<String>),
}
