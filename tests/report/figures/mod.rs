//! What figures show, by their marks, and what their files are.

/// Directories that cannot be drawn, and files that are in the way.
mod command;
/// Files: SVG, PNG, the same bytes every time.
mod files;
/// Where balls come to rest.
mod preferred;
/// The thesis's figures, by coordinates.
mod thesis;

use std::path::Path;

use stickslip::report::chart::{
    Axis, AxisKind, Colour, ColourScale, Figure, Layer, Mark, Panel, Symbol, TipColumn, TipValues,
    Tips,
};
use stickslip::study::Study;

/// A study of the project.
pub fn shipped(name: &str) -> Study {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies");
    Study::load(&folder.join(format!("{name}.yaml"))).unwrap_or_else(|error| panic!("{error}"))
}

fn axis(name: &str, kind: AxisKind) -> Axis {
    Axis { name: name.to_owned(), unit: "m".to_owned(), range: None, kind }
}

fn dots(symbol: Symbol, x: Vec<f64>, y: Vec<f64>) -> Mark {
    let words = TipValues::Words(vec!["w".to_owned(); x.len()]);
    let columns = vec![TipColumn { name: "word".to_owned(), values: words }];
    let run_ids = (0..x.len() as u64).collect();
    Mark::Dots { symbol, x, y, tips: Tips { run_ids, columns } }
}

/// A figure with every kind of mark, axis, colour and symbol, and with words that are hard to write.
pub fn everything() -> Figure {
    let layer = |name: &str, colour, mark| Layer { name: name.to_owned(), colour, mark };
    let x: Vec<f64> = (0..12).map(f64::from).collect();
    let up = |by: f64| x.iter().map(|x| 1.0 + by + x * x / 20.0).collect::<Vec<f64>>();
    let points = |by: f64| x.iter().copied().zip(up(by)).map(|(x, y)| [x, y]).collect::<Vec<_>>();
    let mut gap = points(3.0);
    gap[4] = [f64::NAN; 2];
    let curves = vec![
        layer(
            "band",
            Colour::Series(0),
            Mark::Band { x: x.clone(), low: up(-0.5), high: up(0.5), steps: true },
        ),
        layer("steps", Colour::Series(0), Mark::Steps { points: points(0.0) }),
        layer("line with a gap", Colour::Series(1), Mark::Line { points: gap, dashed: false }),
        layer(
            "intervals",
            Colour::Ink,
            Mark::Intervals { x: x.clone(), low: up(4.0), high: up(5.0) },
        ),
        layer("", Colour::Faint, Mark::Rule { upright: true, at: 3.0, label: "upright".into() }),
        layer("", Colour::Faint, Mark::Rule { upright: false, at: 2.0, label: "level <&>".into() }),
    ];
    let colours = [
        Colour::Equilibrium,
        Colour::LimitCycle,
        Colour::Irregular,
        Colour::Undecided,
        Colour::Failed,
    ];
    let bars = colours.iter().enumerate().map(|(place, colour)| {
        let (base, top) = (place as f64 / 5.0, (place + 1) as f64 / 5.0);
        let mark = Mark::Bars {
            x: vec![0.0, 1.0, 2.0],
            base: vec![base; 3],
            top: vec![top; 3],
            width: 0.7,
        };
        layer(&format!("{colour:?}"), *colour, mark)
    });
    let names =
        ["speed -216.3772 rad/s", "β̇₁ = -1e-3", "a name that is much too long for its place"];
    let symbols = [
        Symbol::Dot,
        Symbol::Disc,
        Symbol::Circle,
        Symbol::Star,
        Symbol::Cross,
        Symbol::Diamond,
        Symbol::Triangle,
        Symbol::Square,
    ];
    let scatter = symbols.iter().enumerate().map(|(place, symbol)| {
        let y = 10.0_f64.powi(place as i32 - 4);
        layer(
            &format!("{symbol:?}"),
            Colour::Series(place),
            dots(*symbol, vec![1.0, 2.0], vec![y; 2]),
        )
    });
    let cells = Mark::Cells {
        edges: (0..9)
            .map(|k| f64::from(k % 3))
            .zip((0..9).map(|k| f64::from(k / 3)))
            .map(|(x, y)| [x, x + 1.0, y, y + 1.0])
            .collect(),
        values: (0..9).map(|k| (k != 4).then(|| f64::from(k) * 1e-7)).collect(),
        tips: Tips::default(),
    };
    let ring = vec![[0.5, 0.5], [2.5, 0.7], [1.5, 2.5]];
    let map = vec![
        layer("", Colour::Scale, cells),
        layer("covered", Colour::Ground, Mark::Regions { rings: vec![ring], values: vec![0.0] }),
        layer("", Colour::Ink, Mark::Words { at: vec![[1.5, 1.2]], words: vec!["word".into()] }),
    ];
    let panel = |title: &str, x, y, scale, layers| Panel {
        title: title.to_owned(),
        part: "a part of it".to_owned(),
        x,
        y,
        scale,
        layers,
    };
    let linear = || axis("abscissa", AxisKind::Linear);
    let scale = ColourScale { name: "value [m]".to_owned(), range: [0.0, 8e-7] };
    Figure {
        id: "everything".to_owned(),
        title: "All <marks> & \"signs\"\u{7}".to_owned(),
        caption: "A caption.".to_owned(),
        alternative: "Every kind of mark.".to_owned(),
        panels: vec![
            panel("curves", linear(), axis("ordinate", AxisKind::Linear), None, curves),
            panel(
                "a title of so many words that they have no room in a line above the panel, nor in two",
                axis("names", AxisKind::Names(names.map(str::to_owned).to_vec())),
                Axis {
                    range: Some([0.0, 1.0]),
                    ..axis(
                        "share of all that there is, at length, and a little more of it than fits",
                        AxisKind::Linear,
                    )
                },
                None,
                bars.collect(),
            ),
            panel(
                "symbols",
                axis("angle", AxisKind::Angle),
                axis("log", AxisKind::Logarithmic),
                None,
                scatter.collect(),
            ),
            panel("map", linear(), linear(), Some(scale), map),
        ],
        one_at_a_time: false,
    }
}
