//! What a figure shows, before it is drawn: panels with axes, and marks at coordinates.
//!
//! Figures are made from tables here and drawn by the page's script. Tests ask for marks and coordinates,
//! not for pixels.

use serde::Serialize;

/// A figure: one panel or several, with the words that go with them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Short and stable, for file names and links, as `time-to-rest`.
    pub id: String,
    /// What it is, in a line.
    pub title: String,
    /// How to read it, and whether anything was left out.
    pub caption: String,
    /// What a reader who does not see it has to know.
    pub alternative: String,
    /// Its panels, in reading order.
    pub panels: Vec<Panel>,
    /// Whether the page shows one panel at a time, to be chosen by its title.
    pub one_at_a_time: bool,
}

/// A pair of axes and what is drawn between them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Panel {
    /// Which point; empty where the figure's title says it.
    pub title: String,
    /// Which part of what is known there; empty where there is one only.
    pub part: String,
    /// The abscissa.
    pub x: Axis,
    /// The ordinate.
    pub y: Axis,
    /// What the colours of cells and rasters mean.
    pub scale: Option<ColourScale>,
    /// What is drawn, the undermost first. Layers of one name share an entry in the legend.
    pub layers: Vec<Layer>,
}

/// An axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Axis {
    /// What it measures, as `speed`.
    pub name: String,
    /// Its unit, as `rad/s`; empty for a pure number.
    pub unit: String,
    /// Where it begins and ends; none: round the marks.
    pub range: Option<[f64; 2]>,
    /// How its values are spread.
    pub kind: AxisKind,
}

/// How the values of an axis are spread.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum AxisKind {
    /// Evenly.
    Linear,
    /// By their logarithm; only positive values.
    Logarithmic,
    /// Evenly from 0 to 2π, with ticks at multiples of π/2.
    Angle,
    /// Names at 0, 1, 2 and so on.
    Names(Vec<String>),
}

/// What the colours of cells and rasters mean: a sequence from pale to dark.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColourScale {
    /// What is measured, with its unit, as `amplitude [µm]`.
    pub name: String,
    /// The values at its two ends.
    pub range: [f64; 2],
}

/// Marks of one kind and meaning.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Layer {
    /// Its entry in the legend; empty for none.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// The marks.
    pub mark: Mark,
}

/// A colour by its meaning; the page decides what it looks like, in its dark and its light theme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Colour {
    /// The colour of text.
    Ink,
    /// Less than text: for what only helps to read.
    Faint,
    /// One of a series that colour-blind readers can tell apart; they repeat after eight.
    Series(usize),
    /// By value, from the panel's scale.
    Scale,
    /// Runs that ended in equilibrium.
    Equilibrium,
    /// Runs that ended in a limit cycle.
    LimitCycle,
    /// Runs of irregular motion.
    Irregular,
    /// Runs of which nothing could be shown.
    Undecided,
    /// Runs that failed.
    Failed,
}

/// A symbol of a dot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Symbol {
    /// A filled disc of so small a size that a hundred thousand of them show a density.
    Dot,
    /// A larger filled disc.
    Disc,
    /// An open circle: unstable.
    Circle,
    /// A star: stable.
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

/// What is drawn, at coordinates of the panel. Lists of one mark are of one length.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// A line through points, in order; broken where a point is not finite.
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
    /// What lies between two lines over the same abscissas, pale.
    Band {
        /// Abscissas.
        x: Vec<f64>,
        /// The lower line.
        low: Vec<f64>,
        /// The upper line.
        high: Vec<f64>,
        /// Whether both stay at a value until the next point.
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
    /// Columns from a base to a top, of a width in units of the abscissa.
    Bars {
        /// Abscissas of their middles.
        x: Vec<f64>,
        /// Where they begin.
        base: Vec<f64>,
        /// Where they end.
        top: Vec<f64>,
        /// Their width.
        width: f64,
    },
    /// Dots.
    Dots {
        /// What they look like.
        symbol: Symbol,
        /// Abscissas.
        x: Vec<f64>,
        /// Ordinates.
        y: Vec<f64>,
        /// What is known of each.
        tooltips: Tooltips,
    },
    /// A picture of values on a regular grid over the whole panel.
    Raster {
        /// Cells along the abscissa and along the ordinate.
        size: [usize; 2],
        /// A value for each cell, row by row from the lower edge; NaN leaves a cell open.
        values: Vec<f64>,
    },
    /// Rectangles with a value each for the colour scale.
    Cells {
        /// Left, right, lower and upper edge of each.
        edges: Vec<[f64; 4]>,
        /// The values; none is left open.
        values: Vec<Option<f64>>,
        /// What is known of each.
        tooltips: Tooltips,
    },
    /// A line across the panel.
    Rule {
        /// Whether it stands upright, at an abscissa.
        upright: bool,
        /// Where.
        at: f64,
        /// What is written at it.
        label: String,
    },
}

/// What is known of each dot: of the run behind it, where there is one, and values by name.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Tooltips {
    /// The run behind each, for `stickslip replay`; empty where dots are not runs.
    pub run_ids: Vec<u64>,
    /// More that is known, column by column.
    pub columns: Vec<TooltipColumn>,
}

/// A column of what is known of dots.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TooltipColumn {
    /// Its name with its unit, as `amplitude [µm]`.
    pub name: String,
    /// A value for each dot.
    pub values: TooltipValues,
}

/// Values of a column.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TooltipValues {
    /// Numbers; NaN where there is none.
    Numbers(Vec<f64>),
    /// Words.
    Words(Vec<String>),
}
