//! A disc that starts: the figure of a few runs that are computed again, and texts that count time from the last stage.

use stickslip::report::chart::{Figure, Layer, Mark, Panel};
use stickslip::report::{Budget, of_results};

use super::{figure_of, reported};
use crate::cli::support::{Scratch, assert_has, counts, numbers};

/// Two ramps, of 0.2 and of 0.4 s, to a plateau of 0.6 s, on which the table is kicked.
const STUDY: &str = "
schema: 1
name: a
seed: 5
model:
  kind: ball_balancer
  parameters: {speed_rad_s: -216.3772}
  speed_profile: [{ramp: {from_rad_s: -100, over_s: 0.2}}, {hold_s: 0.6}]
  disturbances: [{kick: {at_s: 0.5, speed_m_s: 0.05, direction_rad: 0}}]
sweep: [{grid: {ramp_over_s: [0.2, 0.4]}}]
initial_conditions: {design: {monte_carlo: {samples: 4}}}
";

fn part<'a>(figure: &'a Figure, title: &str, part: &str) -> &'a Panel {
    let is = |panel: &&Panel| panel.title == title && panel.part == part;
    figure.panels.iter().find(is).unwrap_or_else(|| panic!("no {part} of {title}"))
}

/// Returns the lines of a panel, one for each run.
fn lines(panel: &Panel) -> Vec<(&Layer, &[[f64; 2]])> {
    let points = panel.layers.iter().filter_map(|layer| match &layer.mark {
        Mark::Line { points, .. } => Some((layer, &points[..])),
        _ => None,
    });
    points.collect()
}

/// A few runs are computed again for the figure, and times are those of the stages.
#[test]
fn the_figures_of_a_disc_that_starts() {
    let scratch = Scratch::with(STUDY);
    let (_, figures) = reported(&scratch, "a.yaml", Budget::SCREEN, of_results);
    let figure = figure_of(&figures, "run-up");
    let runs = scratch.table("out", "runs");
    let [peaks, times] = ["peak_amplitude_m", "peak_time_s"].map(|name| numbers(&runs, name));
    let ends = numbers(&runs, "end_time_s");
    for (point, over_s) in [(0, 0.2), (1, 0.4)] {
        let title = format!("ramp over {over_s} s");
        let over_time = part(figure, &title, "amplitude over time");
        // The dots are those of the table.
        let dots = over_time.layers.iter().find_map(|layer| match &layer.mark {
            Mark::Dots { x, y, tooltips, .. } => Some((x, y, &tooltips.run_ids)),
            _ => None,
        });
        let (x, y, run_ids) = dots.expect("dots at the peaks");
        assert!((2..=4).contains(&run_ids.len()) && run_ids[0] == 4 * point, "{run_ids:?}");
        let lines_over_time = lines(over_time);
        assert_eq!(lines_over_time.len(), run_ids.len());
        for (place, run) in run_ids.iter().enumerate() {
            assert_eq!(counts(&runs, "point_id")[*run as usize], point);
            let peak = peaks[*run as usize].expect("a peak");
            assert_eq!(
                (x[place], y[place]),
                (times[*run as usize].expect("the time of a peak"), 1e6 * peak)
            );
            let (layer, points) = lines_over_time[place];
            assert!(layer.name.starts_with(&format!("run {run}: ")), "{}", layer.name);
            // The curve reaches the peak, and goes to the end of the run.
            let largest = points.iter().map(|point| point[1]).fold(0.0, f64::max);
            let ratio = largest / (1e6 * peak);
            assert!((0.99..1.0 + 1e-9).contains(&ratio), "{ratio}");
            let end = ends[*run as usize].expect("an end");
            assert!((points.last().expect("points of a curve")[0] / end - 1.0).abs() < 0.01);
        }
        // The run with the largest peak of the point is among them.
        let of_point = (4 * point..4 * point + 4).map(|run| peaks[run as usize].expect("a peak"));
        let most = of_point.fold(0.0, f64::max);
        assert!(y.contains(&(1e6 * most)));
        // The speed of the disc, and the amplitude over it in the ramp.
        let speed = |time: f64| -100.0 - 116.3772 * (time / over_s).min(1.0);
        for (_, points) in lines(part(figure, &title, "speed of the disc over time")) {
            assert!(points.iter().all(|[time, found]| (found - speed(*time)).abs() < 1e-9));
        }
        let over_speed = lines(part(figure, &title, "amplitude over the speed of the disc"));
        for ((_, points), (_, over_time)) in over_speed.iter().zip(&lines_over_time) {
            let mut ramp = 0;
            for ([at, amplitude], [time, expected]) in points.iter().zip(*over_time) {
                assert_eq!(at.is_finite(), *time < over_s, "{time} s");
                if at.is_finite() {
                    assert!((at - speed(*time)).abs() < 1e-9 && amplitude == expected);
                    ramp += 1;
                }
            }
            assert!(ramp > 40, "{ramp} values");
        }
        for ball in [1, 2] {
            part(figure, &title, &format!("speed of ball {ball} over time"));
        }
        let kicks = over_time.layers.iter().filter(|layer| {
            matches!(&layer.mark, Mark::Rule { upright: true, at, label } if *at == 0.5 && label == "kick")
        });
        assert_eq!(kicks.count(), 1);
    }
    assert!(figure.alternative.contains("ramp over 0.2 s: the largest amplitude is "));

    // Times to rest count from the begin of the last stage; runs of different points end at different times.
    let caption = |id: &str| &figure_of(&figures, id).caption;
    assert!(
        caption("fractions").contains("0.8 to 1 s after the start"),
        "{}",
        caption("fractions")
    );
    assert!(caption("time-to-rest").contains("by time t after the begin of the last stage"));
    let rest = figure_of(&figures, "time-to-rest");
    let x = &rest.panels[0].x;
    assert_eq!((&*x.name, x.range), ("time after the begin of the last stage", Some([0.0, 0.5])));
    scratch.well("report out");
    let said = ["0.8 to 1 s at most", "largest amplitude of a run [µm]", "at the speed [rad/s]"];
    assert_has(&scratch.text("out-report.html"), &said);
}
