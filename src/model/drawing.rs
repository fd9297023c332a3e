//! Pictures of a machine for an animation: shapes whose points are formulas of its motion.
//!
//! The page of the animation evaluates the formulas, so that they are expressions of JavaScript. In them, `q[0]`, `q[1]` and so on
//! are the drawn quantities, `turned[0]` is the angle of the part that turns, `turned[1]` and `turned[2]` are its speed and its
//! acceleration, and `t` is the time, all in SI units.

use super::{Ball, Machine};
use crate::named::named;

/// Pictures of a machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// The quantities in the formulas: coordinates first, and after them the motions that tables give.
    pub quantities: Vec<DrawnQuantity>,
    /// The pictures.
    pub views: Vec<DrawnView>,
    /// What the page shows over time: names with units, and formulas.
    pub plots: Vec<[String; 2]>,
    /// What the pictures show beside the shapes that explain themselves, in a sentence.
    pub note: String,
}

/// A quantity that moves the shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnQuantity {
    /// What it is.
    pub name: String,
    /// Whether it is an angle, with a period of one turn.
    pub angular: bool,
    /// Whether the page may enlarge it, because it is small beside the machine.
    pub enlarged: bool,
    /// The contact, counted from 0, whose angle it is.
    pub contact: Option<usize>,
}

/// A picture.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnView {
    /// Its name.
    pub name: String,
    /// The frame of its points.
    pub frame: DrawnFrame,
    /// Its shapes; later ones cover earlier ones.
    pub shapes: Vec<DrawnShape>,
}

/// The frame of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawnFrame {
    /// The frame that does not turn; the page shows no other one.
    Only,
    /// The frame that does not turn; the page can turn the picture with the part that turns.
    Fixed,
    /// The frame of the part that turns.
    Turning,
}

/// A shape.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnShape {
    /// What it is.
    pub name: String,
    /// Its form.
    pub form: DrawnForm,
    /// The coordinates of its points in turn, and the radius of a circle; all in the unit of length.
    pub values: Vec<String>,
    /// The contact, counted from 0, whose phase it shows. Gaps between contacts follow after the contacts.
    pub contact: Option<usize>,
}

/// The form of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawnForm {
    /// A circle about a point.
    Circle,
    /// A line through points.
    Line,
    /// A closed line through points, filled.
    Polygon,
    /// A spring between two points.
    Spring,
    /// A dot that shows where a contact is closed.
    Mark,
}

named!(DrawnForm {
    Circle: "circle",
    Line: "line",
    Polygon: "polygon",
    Spring: "spring",
    Mark: "mark",
});

impl Machine {
    /// Returns the picture of a balancer, seen along its axis; `gaps` has the two balls of each gap.
    pub(super) fn drawing(&self, gaps: &[[usize; 2]]) -> Drawing {
        let (radius, balls) = (self.ring_radius_m, self.balls.len());
        let quantity = |name: String, contact: Option<usize>| DrawnQuantity {
            name,
            angular: contact.is_some(),
            enlarged: contact.is_none(),
            contact,
        };
        let table = ["x", "y"].map(|name| quantity(name.to_owned(), None));
        let angles = (0..balls).map(|ball| quantity(format!("ball {}", ball + 1), Some(ball)));
        let shape = |name: String, form: DrawnForm, values: &[String], contact: Option<usize>| {
            DrawnShape { name, form, values: values.to_vec(), contact }
        };
        let text = |value: f64| format!("{value}");
        let centre = ["q[0]", "q[1]"].map(str::to_owned);
        let circle = |radius_m: f64| [&centre[..], &[text(radius_m)]].concat();
        let largest = self.balls.iter().map(|ball| ball.diameter_m).fold(0.0, f64::max);
        let on_ring = |ball: usize| {
            ["cos", "sin"].map(|part| format!("{radius}*Math.{part}(q[{}])", 2 + ball))
        };
        let place = |ball: usize| {
            let [right, up] = on_ring(ball);
            [format!("q[0]+{right}"), format!("q[1]+{up}")]
        };
        let corner = |along: f64, up: f64| {
            [format!("q[0]+{}", along * radius), format!("q[1]+({})", up * radius)]
        };
        let imbalance = [corner(0.62, -0.07), corner(0.76, 0.0), corner(0.62, 0.07)].concat();
        let mut shapes = vec![
            shape("ring".to_owned(), DrawnForm::Circle, &circle(radius + largest / 2.0), None),
            shape("axis".to_owned(), DrawnForm::Circle, &circle(0.015 * radius), None),
            shape("imbalance".to_owned(), DrawnForm::Polygon, &imbalance, None),
        ];
        for (ball, Ball { diameter_m, .. }) in self.balls.iter().enumerate() {
            let values = [&place(ball)[..], &[text(diameter_m / 2.0)]].concat();
            shapes.push(shape(
                format!("ball {}", ball + 1),
                DrawnForm::Circle,
                &values,
                Some(ball),
            ));
        }
        for (number, [behind, ahead]) in gaps.iter().enumerate() {
            // Where the circles meet.
            let [first, second] = [behind, ahead].map(|ball| self.balls[*ball].diameter_m);
            let share = first / (first + second);
            let [from, to] = [behind, ahead].map(|ball| on_ring(*ball));
            let between = [0, 1].map(|axis| {
                format!("q[{axis}]+{}*{}+{share}*{}", 1.0 - share, from[axis], to[axis])
            });
            let name = format!("balls {} and {}", behind + 1, ahead + 1);
            shapes.push(shape(name, DrawnForm::Mark, &between, Some(balls + number)));
        }
        Drawing {
            quantities: table.into_iter().chain(angles).collect(),
            views: vec![DrawnView { name: "end".to_owned(), frame: DrawnFrame::Turning, shapes }],
            plots: vec![
                ["displacement of the table [mm]", "1000*Math.hypot(q[0],q[1])"].map(str::to_owned),
            ],
            note: "The triangle points to the imbalance; angles are counted from there, counterclockwise."
                .to_owned(),
        }
    }
}
