//! What is drawn on paper: paths and words at places in points (1/72 inch), y downwards.

/// A colour with its opacity from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// Red, green and blue.
    pub rgb: [u8; 3],
    /// Opacity.
    pub opacity: f64,
}

impl Paint {
    /// An opaque colour.
    pub const fn of(rgb: [u8; 3]) -> Self {
        Paint { rgb, opacity: 1.0 }
    }
}

/// How a line is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub paint: Paint,
    /// Its width.
    pub width: f64,
    /// Lengths of dashes and gaps; empty for none.
    pub dash: Vec<f64>,
}

/// A step of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Begins at a point.
    Move([f64; 2]),
    /// A straight line to a point.
    Line([f64; 2]),
    /// Back to where it began.
    Close,
    /// A circle about a point.
    Circle([f64; 2], f64),
    /// A point that a round stroke makes a disc.
    Point([f64; 2]),
}

/// A rectangle: left, top, right, bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box2 {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
}

impl Box2 {
    /// Its outline.
    pub fn steps(&self) -> Vec<Step> {
        let Box2 { left, top, right, bottom } = *self;
        vec![
            Step::Move([left, top]),
            Step::Line([right, top]),
            Step::Line([right, bottom]),
            Step::Line([left, bottom]),
            Step::Close,
        ]
    }
}

/// Where a text is at its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Begins there.
    Start,
    /// Has its middle there.
    Middle,
    /// Ends there.
    End,
}

/// What is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// A path.
    Path {
        /// Its steps.
        steps: Vec<Step>,
        /// The colour of its inside.
        fill: Option<Paint>,
        /// Its line.
        stroke: Option<Stroke>,
        /// What of it is seen.
        clip: Option<Box2>,
    },
    /// Words.
    Text {
        /// Where on the line of writing.
        at: [f64; 2],
        /// Height of the font.
        size: f64,
        /// Which end is there.
        anchor: Anchor,
        /// Turned about the point, degrees, clockwise.
        turned: f64,
        /// The words.
        words: String,
    },
}

/// A picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Width and height.
    pub size: [f64; 2],
    /// What is drawn, the undermost first.
    pub items: Vec<Item>,
}

impl Scene {
    /// Adds words.
    pub fn text(&mut self, at: [f64; 2], size: f64, anchor: Anchor, words: &str) {
        let words = words.to_owned();
        self.items.push(Item::Text { at, size, anchor, turned: 0.0, words });
    }

    /// Adds a line.
    pub fn line(&mut self, steps: Vec<Step>, stroke: Stroke, clip: Option<Box2>) {
        if !steps.is_empty() {
            self.items.push(Item::Path { steps, fill: None, stroke: Some(stroke), clip });
        }
    }

    /// Adds an area.
    pub fn area(&mut self, steps: Vec<Step>, fill: Paint, clip: Option<Box2>) {
        if !steps.is_empty() {
            self.items.push(Item::Path { steps, fill: Some(fill), stroke: None, clip });
        }
    }
}
