//! The page of a hundred thousand runs is small enough to be mailed, and responsive.
//!
//! Times are printed, not asserted: `cargo test --test page report_large -- --nocapture`.

use std::fs;

use serde_json::Value;

use super::browser::Browser;
use super::page::{LAPTOP, Page};
use super::results::Made;

const STUDY: &str = "schema: 1
name: large
seed: 4
model: {kind: block_on_spring, parameters: {mass_kg: 1, stiffness_n_m: 100, normal_force_n: 10}}
sweep: [{grid: {friction_coefficient: [0.05, 0.1, 0.2, 0.3]}}]
initial_conditions: {box: {position_m: [-0.1, 0.1], velocity_m_s: [-1, 1]}, design: {sobol: {samples: 25000}}}
simulation: {end_time_s: 30}
";

/// Measures the times between frames from now on, ms.
fn watch(page: &mut Page<'_>) {
    page.ask(
        "(() => {
            window.intervals = [];
            let before = performance.now();
            const next = now => { intervals.push(now - before); before = now; window.watching = requestAnimationFrame(next); };
            requestAnimationFrame(next);
        })()",
    );
}

/// Ends the measurement: median and 95 % quantile of the times, ms.
fn watched(page: &mut Page<'_>) -> [f64; 2] {
    page.ask("cancelAnimationFrame(watching)");
    let mut times: Vec<f64> = serde_json::from_value(page.ask("intervals")).unwrap();
    times.sort_by(f64::total_cmp);
    [0.5, 0.95].map(|part| times[(part * (times.len() - 1) as f64) as usize])
}

#[test]
fn a_hundred_thousand_runs() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    made.write("large.yaml", STUDY);
    made.runs("run large.yaml --out large");
    made.well("report large");
    let file = made.path("large-report.html");
    let bytes = fs::metadata(&file).unwrap().len();
    assert!(bytes < 5_000_000, "{bytes} bytes");

    let mut page = browser.open(&file, LAPTOP);
    let loaded = page.number("performance.getEntriesByType('navigation')[0].loadEventEnd");
    watch(&mut page);
    page.ask(
        "(async () => {
            for (let y = 0; y < document.body.scrollHeight; y += 40) {
                scrollTo({top: y, behavior: 'instant'});
                await new Promise(requestAnimationFrame);
            }
        })()",
    );
    let scrolling = watched(&mut page);
    let charts = page.number("document.querySelectorAll('.chart > div').length");
    assert!(charts >= 4.0, "{charts} charts are drawn");

    // The pointer crosses the figure with the most dots.
    page.ask(
        "document.getElementById('preferred-equilibria').scrollIntoView({behavior: 'instant'})",
    );
    page.frames(5);
    let chart = page.ask(
        "(() => { const box = document.querySelector('#preferred-equilibria .chart').getBoundingClientRect();
           return [box.left, box.top, box.width, box.height]; })()",
    );
    let [left, top, width, height]: [f64; 4] = serde_json::from_value(chart).unwrap();
    watch(&mut page);
    let mut told = 0;
    for step in 0..60 {
        let part = 0.15 + 0.7 * f64::from(step) / 60.0;
        page.move_to((left + width * part, top + height * (0.25 + 0.5 * part)));
        let tip =
            page.ask("document.querySelector('#preferred-equilibria .chart .tip')?.innerText");
        told += usize::from(tip != Value::Null);
    }
    let hovering = watched(&mut page);
    assert!(told > 0, "no tooltip was shown");
    assert_eq!(page.faults(), [""; 0]);
    println!(
        "10^5 runs: {:.1} MB, loaded in {loaded:.0} ms; between frames, median and 95 %: {:.0} and {:.0} ms \
         scrolling, {:.0} and {:.0} ms under the pointer",
        bytes as f64 / 1e6,
        scrolling[0],
        scrolling[1],
        hovering[0],
        hovering[1],
    );
}
