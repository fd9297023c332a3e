//! `docs/convergence.svg`: errors against tolerance and band, on logarithmic axes.

use plotters::coord::Shift;
use plotters::prelude::*;
use stickslip::model::Method;

use super::generated::compare_or_write;
use crate::ending::convergence::{Errors, errors};

/// One of the measured quantities: its name, its colour, and its error.
type Quantity = (&'static str, RGBColor, fn(&Errors) -> f64);

const QUANTITIES: [Quantity; 4] = [
    ("time of rest", RGBColor(0, 90, 181), |all| all.rest_time),
    ("place of rest", RGBColor(220, 90, 0), |all| all.rest_position),
    ("period", RGBColor(0, 130, 90), |all| all.period),
    ("amplitude", RGBColor(140, 60, 150), |all| all.amplitude),
];

/// One part of the picture.
struct Panel {
    title: &'static str,
    abscissa: &'static str,
    powers: std::ops::RangeInclusive<i32>,
    errors: fn(f64) -> Errors,
}

const PANELS: [Panel; 3] = [
    Panel {
        title: "event method",
        abscissa: "relative tolerance per step",
        powers: 3..=12,
        errors: |tolerance| errors(Method::Event, tolerance, 1e-8),
    },
    Panel {
        title: "switch model, band 1e-8",
        abscissa: "relative tolerance per step",
        powers: 3..=12,
        errors: |tolerance| errors(Method::Switch, tolerance, 1e-8),
    },
    Panel {
        title: "switch model, tolerance 1e-12",
        abscissa: "half width of the band, non-dimensional",
        powers: 2..=10,
        errors: |band| errors(Method::Switch, 1e-12, band),
    },
];

fn draw(area: &DrawingArea<SVGBackend, Shift>, panel: &Panel) {
    let abscissae: Vec<f64> = panel.powers.clone().map(|power| 10.0_f64.powi(-power)).collect();
    let measured: Vec<(f64, Errors)> = abscissae.iter().map(|&x| (x, (panel.errors)(x))).collect();
    let (most, least) = (abscissae[0], abscissae[abscissae.len() - 1]);
    let mut chart = ChartBuilder::on(area)
        .caption(panel.title, ("sans-serif", 20))
        .margin(8)
        .x_label_area_size(42)
        .y_label_area_size(62)
        .build_cartesian_2d((0.5 * least..2.0 * most).log_scale(), (1e-14_f64..1e-1).log_scale())
        .expect("axes");
    chart
        .configure_mesh()
        .x_desc(panel.abscissa)
        .y_desc("relative error")
        .label_style(("sans-serif", 16))
        .x_labels(6)
        .y_labels(8)
        .x_label_formatter(&|x| format!("1e{:.0}", x.log10()))
        .y_label_formatter(&|y| format!("1e{:.0}", y.log10()))
        .light_line_style(TRANSPARENT)
        .bold_line_style(RGBColor(225, 225, 225))
        .draw()
        .expect("a mesh");
    let proportional = abscissae.iter().map(|&x| (x, x));
    chart
        .draw_series(DashedLineSeries::new(proportional, 4, 4, BLACK.into()))
        .expect("a line")
        .label("in proportion")
        .legend(|(x, y)| {
            plotters::element::DashedPathElement::new([(x, y), (x + 16, y)], 4, 4, BLACK)
        });
    for (name, colour, pick) in QUANTITIES {
        let points = || measured.iter().map(|(x, all)| (*x, pick(all).max(1e-14)));
        chart.draw_series(LineSeries::new(points(), &colour)).expect("a line");
        chart
            .draw_series(points().map(|point| Circle::new(point, 3, colour.filled())))
            .expect("points")
            .label(name)
            .legend(move |(x, y)| Circle::new((x + 8, y), 3, colour.filled()));
    }
    chart
        .configure_series_labels()
        .label_font(("sans-serif", 15))
        .position(SeriesLabelPosition::UpperLeft)
        .background_style(WHITE)
        .border_style(RGBColor(200, 200, 200))
        .draw()
        .expect("a legend");
}

/// What the tests in `tests/ending/convergence.rs` assert, to be seen.
#[test]
fn picture_of_convergence() {
    let mut picture = String::new();
    {
        let root = SVGBackend::with_string(&mut picture, (1200, 460)).into_drawing_area();
        root.fill(&WHITE).expect("white paper");
        let panels = root.split_evenly((1, 3));
        panels.iter().zip(&PANELS).for_each(|(area, panel)| draw(area, panel));
        root.present().expect("drawn");
    }
    compare_or_write("docs/convergence.svg", &picture);
}
