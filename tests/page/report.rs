//! The page of `stickslip report` shows the content of the tables; by mouse and keys, in light and
//! dark mode, in narrow windows and on paper.

use std::fs;
use std::path::PathBuf;

use serde_json::Value;

use super::browser::Browser;
use super::page::{DARK, LAPTOP, Page, View, kept};
use super::results::Made;

/// Five speeds of the thesis and a tenth of the friction; 8 runs each, half of them audited.
const THESIS: &str = "schema: 1
name: thesis
seed: 2003
model: {kind: ball_balancer}
sweep:
  - grid: {speed_rad_s: [-160.8103, -173.1803, -179.2671, -191.6372, -216.3772]}
  - zip: {speed_rad_s: [-216.3772], friction_coefficient: [2.75e-4]}
initial_conditions: {design: {latin_hypercube: {samples: 8}}}
simulation: {end_time_s: 16.5}
audit: {fraction: 0.5}
";
/// Half of the runs fail.
const FAILING: &str = "schema: 1
name: failing
seed: 5
model: {kind: ball_balancer, parameters: {table_mass_kg: 2.0e-2, ball_mass_kg: 1.5e-1, speed_rad_s: -60, friction_coefficient: 3}}
initial_conditions: {design: {monte_carlo: {samples: 12}}}
simulation: {end_time_s: 1}
";
const CYCLES: &str = "schema: 1
name: cycles
seed: 247
model: {kind: ball_balancer}
sweep: [{grid: {speed_rad_s: [-260, -280]}}]
initial_conditions: {design: {monte_carlo: {samples: 4}}}
simulation: {end_time_s: 66}
";
const THREE: &str = "schema: 1
name: three
seed: 5
model: {kind: ball_balancer, parameters: {balls: 3}}
initial_conditions: {design: {monte_carlo: {samples: 4}}}
simulation: {end_time_s: 3}
";
const SPRING: &str = "schema: 1
name: spring
seed: 4
model: {kind: block_on_spring}
sweep: [{grid: {friction_coefficient: [0, 0.1, 0.2], stiffness_n_m: [50, 100]}}]
initial_conditions: {design: {latin_hypercube: {samples: 8}}}
simulation: {end_time_s: 5}
";

/// Three uncertain parameters of a balancer.
const UNCERTAIN: &str = "schema: 1
name: uncertain
seed: 6
model: {kind: ball_balancer}
sweep: [{grid: {speed_rad_s: [-160.8103, -216.3772]}}]
uncertain:
  imbalance_mass_kg: {normal: {mean: 5.6e-5, std_dev: 5.0e-6}}
  stiffness_n_m: {times: {uniform: {min: 0.9, max: 1.1}}}
  friction_coefficient: {uniform: {min: 1.0e-3, max: 3.0e-3}}
initial_conditions: {design: {latin_hypercube: {samples: 24}}}
simulation: {end_time_s: 8}
";
/// A search for the stiffness and the friction with which a block stops fast and does not move far.
const SEARCH: &str = "schema: 1
name: search
seed: 1
model: {kind: block_on_spring}
initial_conditions: {box: {position_m: [0.045, 0.045]}, design: {monte_carlo: {samples: 4}}}
simulation: {end_time_s: 10}
design: {stiffness_n_m: {from: 30, to: 200}, friction_coefficient: {from: 0.05, to: 0.3}}
responses: {stop: median_time_to_rest, far: {amplitude_mean: {}}, soon: {at_rest_by_s: 1}}
optimize: {minimize: OBJECTIVES, subject_to: {soon: {at_least: 0.5}}, designs: 10, start_designs: 10, finalists: 3,
  compare_with: {stiffness_n_m: 100, friction_coefficient: 0.1}}
";

fn search_page(made: &Made, objectives: &str, directory: &str) -> PathBuf {
    made.write("search.yaml", &SEARCH.replace("OBJECTIVES", objectives));
    made.well(&format!("optimize search.yaml --quiet --out {directory}"));
    made.well(&format!("report {directory}"));
    made.path(&format!("{directory}-report.html"))
}

/// Returns the page of a study with its results in this directory.
fn report(made: &Made, study: &str, directory: &str) -> PathBuf {
    made.write("study.yaml", study);
    made.runs(&format!("run study.yaml --out {directory}"));
    made.well(&format!("report {directory}"));
    made.path(&format!("{directory}-report.html"))
}

#[track_caller]
fn figures(page: &mut Page<'_>) -> Vec<String> {
    let ids = page.ask("[...document.querySelectorAll('figure')].map(figure => figure.id)");
    serde_json::from_value(ids).unwrap()
}

/// Scrolls to a figure and waits until it is drawn.
#[track_caller]
fn see(page: &mut Page<'_>, id: &str) {
    page.ask(&format!(
        "document.getElementById('{id}').scrollIntoView({{behavior: 'instant', block: 'start'}})"
    ));
    page.wait_until(&chart(id));
    page.frames(2);
}

fn chart(id: &str) -> String {
    format!("echarts.getInstanceByDom(document.querySelector('#{id} .chart'))")
}

/// Returns the coordinates of the dots of a series.
#[track_caller]
fn dots(page: &mut Page<'_>, id: &str, name: &str) -> Vec<[f64; 2]> {
    let dots = page.ask(&format!(
        "{}.getOption().series.filter(series => series.type === 'scatter' && series.name === {name:?})
            .flatMap(series => series.data)",
        chart(id)
    ));
    serde_json::from_value(dots).unwrap()
}

/// Selects an option of a figure.
#[track_caller]
fn choose(page: &mut Page<'_>, id: &str, which: usize, option: usize) {
    page.ask(&format!(
        "(() => {{
            const select = document.querySelectorAll('#{id} select')[{which}];
            select.selectedIndex = {option};
            select.dispatchEvent(new Event('change'));
        }})()"
    ));
    page.frames(2);
}

/// Every figure is accessible in windows of all sizes.
#[test]
fn pages_have_no_faults() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    for (name, study) in [
        ("thesis", THESIS),
        ("failing", FAILING),
        ("cycles", CYCLES),
        ("three", THREE),
        ("spring", SPRING),
        ("uncertain", UNCERTAIN),
    ] {
        let file = report(&made, study, name);
        assert!(fs::metadata(&file).unwrap().len() < 5_000_000, "{name}");
        // The first study in every view; the others wide in light and narrow in dark colours.
        let views: &[View] = match name {
            "thesis" => {
                &[LAPTOP, DARK, View { width: 1024, ..LAPTOP }, View { width: 390, ..LAPTOP }]
            }
            _ => &[LAPTOP, View { width: 390, ..DARK }],
        };
        for &view in views {
            let mut page = browser.open(&file, view);
            let figures = figures(&mut page);
            assert!(figures.len() >= 4, "{name}: {figures:?}");
            in_words(&mut page);
            let View { width, dark, .. } = view;
            page.ask("scrollTo({top: 0, behavior: 'instant'})");
            let scheme = if dark { "dark" } else { "light" };
            page.screenshot(&format!("report-{name}-{width}-{scheme}"));
            assert_eq!(page.faults(), [""; 0], "{name}");
            assert!(!page.wider_than_window(), "{name}, {width} px");
            let (pale, texts) = page.pale();
            assert!(texts > 100 && pale.is_empty(), "{name}, {width} px: {texts} texts, {pale:?}");
            assert_eq!(page.nameless(), [], "{name}");
            let over = page.overlapping();
            assert!(over.is_empty(), "{name}, {width} px: {over:?}");
        }
    }
}

/// Dots are the runs of the tables, at their positions, and descriptions in words state what figures show.
#[test]
fn figures_show_what_is_in_the_tables() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let mut page = browser.open(&report(&made, THESIS, "a"), LAPTOP);
    assert_eq!(page.text("document.title"), "thesis: stickslip report");
    assert_eq!(page.text("document.documentElement.lang"), "en");
    let runs = |column: &str| made.numbers("a/runs.parquet", column);
    let (points, first, second) = (runs("point_id"), runs("beta_1_rad"), runs("beta_2_rad"));
    let labels = made.words("a/runs.parquet", "label");
    let starts = [runs("initial_beta_1"), runs("initial_beta_2")];
    let near = |found: &[[f64; 2]], expected: &[[f64; 2]], what: &str| {
        assert_eq!(found.len(), expected.len(), "{what}");
        for (found, expected) in found.iter().zip(expected) {
            let off = (0..2).map(|axis| (found[axis] - expected[axis]).abs()).fold(0.0, f64::max);
            // Coordinates are packed: 16 bits for a turn.
            assert!(off < 2e-4, "{what}: {found:?}, not {expected:?}");
        }
    };
    see(&mut page, "preferred-equilibria");
    see(&mut page, "basins");
    let mut rested = 0;
    for point in 0..6 {
        let at_point = |run: &usize| points[*run] == point as f64;
        let of = |label: &str| -> Vec<usize> {
            (0..labels.len()).filter(at_point).filter(|run| labels[*run] == label).collect()
        };
        choose(&mut page, "preferred-equilibria", 0, point);
        let resting: Vec<[f64; 2]> =
            of("equilibrium").into_iter().map(|run| [first[run], second[run]]).collect();
        rested += resting.len();
        let found = dots(&mut page, "preferred-equilibria", "equilibrium");
        near(&found, &resting, &format!("point {point} at rest"));

        choose(&mut page, "basins", 0, point);
        for label in ["equilibrium", "limit_cycle", "irregular", "undecided", "failed"] {
            let expected: Vec<[f64; 2]> =
                of(label).into_iter().map(|run| [starts[0][run], starts[1][run]]).collect();
            let found = dots(&mut page, "basins", &label.replace('_', " "));
            near(&found, &expected, &format!("point {point}, {label} at the start"));
        }
    }
    assert!(rested > 10);

    // A dot for each point of the sweep.
    see(&mut page, "fractions");
    let speeds = made.numbers("a/points.parquet", "speed_rad_s");
    let fraction = made.numbers("a/points.parquet", "equilibrium_fraction");
    let mut expected: Vec<[f64; 2]> =
        (0..5).map(|point| [speeds[point], fraction[point]]).collect();
    let mut found = dots(&mut page, "fractions", "equilibrium");
    for values in [&mut expected, &mut found] {
        values.sort_by(|a, b| a[0].total_cmp(&b[0]));
    }
    near(&found, &expected, "fractions");
    // A curve for each point, which ends at its fraction.
    see(&mut page, "time-to-rest");
    let last = page.ask(&format!(
        "{}.getOption().series.filter(series => series.type === 'line')
            .map(series => series.data[series.data.length - 1][1])",
        chart("time-to-rest")
    ));
    let last: Vec<f64> = serde_json::from_value(last).unwrap();
    assert_eq!(last.len(), 6);
    for (last, fraction) in last.iter().zip(&fraction) {
        assert!((last - fraction).abs() < 1e-6, "{last} {fraction}");
    }
    // The table of points.
    let rows = page.ask(
        "[...document.querySelectorAll('#points ~ .wide tbody tr')]
            .map(row => [...row.cells].map(cell => cell.textContent))",
    );
    let rows: Vec<Vec<String>> = serde_json::from_value(rows).unwrap();
    assert_eq!(rows.len(), 6);
    for (row, fraction) in rows.iter().zip(&fraction) {
        assert!(row.contains(&format!("{:.1}", 100.0 * fraction)), "{fraction} not in {row:?}");
    }
    let told = page.text("document.getElementById('preferred-equilibria-words').textContent");
    for fraction in fraction {
        let words = format!(": {} of 8 runs came to rest", (8.0 * fraction).round());
        assert!(told.contains(&words), "no {words} in {told}");
    }
    assert_eq!(page.faults(), [""; 0]);
}

/// Returns the position of a dot in the window, px.
#[track_caller]
fn place_of(page: &mut Page<'_>, id: &str, name: &str, index: usize) -> (f64, f64) {
    let place = page.ask(&format!(
        "(() => {{
            const box = document.querySelector('#{id} .chart'), chart = echarts.getInstanceByDom(box);
            const all = chart.getOption().series;
            const series = all.findIndex(series => series.type === 'scatter' && series.name === {name:?});
            const [x, y] = chart.convertToPixel({{seriesIndex: series}}, all[series].data[{index}]);
            const {{left, top}} = box.getBoundingClientRect();
            return [left + x, top + y];
        }})()"
    ));
    (place[0].as_f64().unwrap(), place[1].as_f64().unwrap())
}

/// Returns the text of a figure's tooltip; empty without a tooltip.
#[track_caller]
fn tooltip(page: &mut Page<'_>, id: &str) -> String {
    page.text(&format!(
        "(() => {{
            const tip = [...document.querySelectorAll('#{id} .chart .tip')].pop();
            const shown = tip && tip.checkVisibility({{visibilityProperty: true, opacityProperty: true}});
            return shown ? tip.innerText : '';
        }})()"
    ))
}

#[test]
fn a_dot_has_a_tooltip_about_its_run() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let mut page = browser.open(&report(&made, THESIS, "r&d"), LAPTOP);
    let id = "preferred-equilibria";
    see(&mut page, id);
    choose(&mut page, id, 0, 4);
    let (labels, points) =
        (made.words("r&d/runs.parquet", "label"), made.numbers("r&d/runs.parquet", "point_id"));
    let runs: Vec<usize> = (0..labels.len())
        .filter(|run| labels[*run] == "equilibrium" && points[*run] == 4.0)
        .collect();
    let of = |column: &str, run: usize| made.numbers("r&d/runs.parquet", column)[run];
    for (index, run) in runs.iter().copied().enumerate().take(2) {
        assert_eq!(tooltip(&mut page, id), "");
        let place = place_of(&mut page, id, "equilibrium", index);
        page.move_to(place);
        page.wait_until(&format!("document.querySelector('#{id} .chart .tip')"));
        page.frames(5);
        let said = tooltip(&mut page, id);
        let command = format!("stickslip replay 'r&d' {run}");
        let number = |name: &str| -> f64 {
            let line = said.lines().find(|line| line.starts_with(name));
            let line = line.unwrap_or_else(|| panic!("no {name} in {said}"));
            line[name.len()..].trim().replace('−', "-").parse().unwrap()
        };
        assert!(said.contains(&format!("run {run}")) && said.contains(&command), "{said}");
        for (name, expected, tolerance) in [
            ("angle of ball 1 [rad]", of("beta_1_rad", run), 2e-4),
            ("angle of ball 2 [rad]", of("beta_2_rad", run), 2e-4),
            ("amplitude [µm]", 1e6 * of("amplitude_m", run), 1e-2),
            ("friction margin", of("friction_margin", run), 1e-5),
        ] {
            let found = number(name);
            assert!((found - expected).abs() < tolerance, "{name}: {found}, not {expected}");
        }
        // A click pins it, with a button that copies the command.
        page.click(place);
        page.wait_until(&format!("document.querySelector('#{id} .picked button')"));
        let kept = page.text(&format!("document.querySelector('#{id} .picked code').textContent"));
        assert_eq!(kept, command);
        page.move_to((5.0, 5.0));
        page.wait_until(&format!(
            "![...document.querySelectorAll('#{id} .chart .tip')].some(tip => tip.checkVisibility({{
                visibilityProperty: true, opacityProperty: true}}))"
        ));
    }
    page.screenshot("report-hover");
    assert_eq!(page.faults(), [""; 0]);
}

#[test]
fn a_legend_hides_and_shows() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let mut page = browser.open(&report(&made, THESIS, "a"), LAPTOP);
    for id in figures(&mut page) {
        see(&mut page, &id);
        let buttons = format!("#{id} .legend button");
        let count = page.number(&format!("document.querySelectorAll('{buttons}').length"));
        for index in 1..=count as usize {
            let button = format!("{buttons}:nth-child({index})");
            let state = format!(
                "[{}.getOption().series.length, document.querySelector('{button}').ariaPressed]",
                chart(&id)
            );
            let before = page.ask(&state);
            page.click_on(&button);
            let hidden = page.ask(&state);
            assert!(hidden[0].as_u64() < before[0].as_u64(), "{button}: {before} {hidden}");
            assert_eq!((&before[1], &hidden[1]), (&"true".into(), &"false".into()), "{button}");
            // By keyboard: the focus is unchanged.
            page.key("Enter");
            assert_eq!(page.ask(&state), before, "{button}");
        }
    }
    assert_eq!(page.faults(), [""; 0]);
}

#[test]
fn a_keyboard_reaches_everything() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let mut page = browser.open(&report(&made, THESIS, "a"), LAPTOP);
    let figures = figures(&mut page);
    for id in &figures {
        see(&mut page, id);
    }
    page.ask("scrollTo({top: 0, behavior: 'instant'})");
    // By Tab from the beginning to the end: every control, every figure, every table.
    let reach =
        "[...document.querySelectorAll('a[href], button, select, summary, [tabindex=\"0\"]')]
        .filter(part => part.checkVisibility()).length";
    let all = page.number(reach) as usize;
    page.ask("window.reached = new Set(); document.activeElement.blur()");
    // Newer browsers also stop at every region that can be scrolled.
    for _ in 0..2 * all {
        page.key("Tab");
        page.ask("reached.add(document.activeElement); null");
    }
    let missed = page.ask(
        "[...document.querySelectorAll('a[href], button, select, summary, [tabindex=\"0\"]')]
            .filter(part => part.checkVisibility() && !reached.has(part)).map(part => part.outerHTML)",
    );
    assert_eq!(missed, Value::Array(vec![]));
    for id in &figures {
        let there = format!("reached.has(document.querySelector('#{id} .chart'))");
        assert_eq!(page.ask(&there), true, "{id}");
        // The focus is visible.
        page.ask(&format!("document.querySelector('#{id} .chart').focus()"));
        page.key("Shift+Tab");
        page.key("Tab");
        let outline = page.text("getComputedStyle(document.activeElement).outlineStyle");
        assert_eq!(
            (page.ask("document.activeElement.className.includes('chart')"), outline.as_str()),
            (Value::Bool(true), "solid"),
            "{id}"
        );
    }

    // Dot by dot with the arrow keys, announced in words.
    let id = "preferred-equilibria";
    see(&mut page, id);
    page.ask(&format!("document.querySelector('#{id} .chart').focus()"));
    let picked = format!("document.querySelector('#{id} .picked').textContent");
    let mut told = Vec::new();
    for key in ["Home", "ArrowRight", "ArrowRight", "ArrowLeft", "End"] {
        page.key(key);
        told.push(page.text(&picked));
    }
    assert!(told[0].contains("run 0: ") && told[0].contains("stickslip replay a 0"), "{told:?}");
    assert!(told[0] != told[1] && told[1] != told[2] && told[3] == told[1], "{told:?}");
    assert!(told[4].contains("without friction"), "{told:?}");
    assert_eq!(page.faults(), [""; 0]);
}

/// Asserts that every figure has a name and a description.
#[track_caller]
fn in_words(page: &mut Page<'_>) {
    for id in figures(page) {
        see(page, &id);
        let words = page.ask(&format!(
            "(() => {{
                const figure = document.getElementById('{id}'), chart = figure.querySelector('.chart');
                return [chart.getAttribute('role'), chart.ariaLabel + '|' +
                        document.getElementById(chart.getAttribute('aria-describedby')).textContent,
                    figure.closest('section').querySelector('h2').textContent,
                    figure.querySelector('details p').textContent, figure.querySelector('figcaption').innerText];
            }})()"
        ));
        let [role, label, title, told, caption]: [String; 5] =
            serde_json::from_value(words).unwrap();
        assert_eq!(role, "application", "{id}");
        assert!(label.starts_with(&title) && label.contains(&told), "{id}: {label}");
        assert!(told.len() > 15 && caption.len() > 30, "{id}: {told} / {caption}");
    }
}

/// Width and height of the printed area of A4 with the browser's margins of a centimetre, px.
const PAPER: View = View { width: 718, height: 1046, print: true, ..LAPTOP };

/// The words in the heads of tables that lie on several lines; a name may break after an underscore.
const BROKEN_WORDS: &str = "[...document.querySelectorAll('th')].flatMap(cell => {
    const texts = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT), broken = [];
    while (texts.nextNode()) for (const word of texts.currentNode.data.matchAll(/[^ ]+/g)) {
        const range = document.createRange();
        range.setStart(texts.currentNode, word.index);
        range.setEnd(texts.currentNode, word.index + word[0].length);
        if (range.getClientRects().length !== 1) broken.push(word[0]);
    }
    return broken;
})";

#[test]
fn a_report_can_be_printed() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    for (name, study) in [("thesis", THESIS), ("failing", FAILING), ("uncertain", UNCERTAIN)] {
        let file = report(&made, study, name);
        // Colours are those of paper in either scheme; one study shows it.
        let schemes: &[bool] = if name == "thesis" { &[false, true] } else { &[true] };
        for &dark in schemes {
            // Without scrolling, everything is drawn for the print.
            let mut page = browser.open(&file, View { dark, ..LAPTOP });
            let figures = figures(&mut page);
            let sheets = page.pdf(&format!("report-{name}-{dark}")).sheets();
            assert!((2..=figures.len() + 4).contains(&sheets), "{name}: {sheets} sheets");
            for id in &figures {
                assert_eq!(
                    page.ask(&format!("!!{}", chart(id))),
                    true,
                    "{name}: {id} is not drawn"
                );
            }
            page.view(View { dark, ..PAPER });
            page.ask("dispatchEvent(new Event('beforeprint'))");
            page.frames(5);
            page.screenshot(&format!("report-{name}-print-{dark}"));
            assert_eq!(
                page.text("getComputedStyle(document.body).backgroundColor"),
                "rgb(255, 255, 255)"
            );
            let (pale, texts) = page.pale();
            assert!(texts > 100 && pale.is_empty(), "{name}: {texts} texts, {pale:?}");
            for id in &figures {
                let parts = page.ask(&format!(
                    "(() => {{
                        const figure = document.getElementById('{id}');
                        const parts = [...figure.querySelectorAll('.chart, .chart svg, .chart canvas, .legend button, .scale')];
                        const {{height}} = figure.getBoundingClientRect();
                        const right = Math.max(...parts.map(part => part.getBoundingClientRect().right));
                        return [height, right, getComputedStyle(figure).breakInside];
                    }})()"
                ));
                let (height, right) = (parts[0].as_f64().unwrap(), parts[1].as_f64().unwrap());
                let (widest, highest) = (f64::from(PAPER.width), f64::from(PAPER.height));
                assert!(right <= widest + 0.5, "{name}: {id} ends at {right} px");
                assert!(height <= highest, "{name}: {id} is {height} px high");
                assert_eq!(parts[2], "avoid", "{name}: {id}");
            }
            let over = page.overlapping();
            assert!(over.is_empty(), "{name} on paper: {over:?}");
            let broken = page.ask(BROKEN_WORDS);
            assert_eq!(broken, Value::Array(vec![]), "{name} on paper");
            assert!(!page.wider_than_window(), "{name} on paper");
            assert_eq!(page.faults(), [""; 0]);
        }
    }
}

/// Returns what a button saves: the file's name and its content as a URL.
#[track_caller]
fn saved(page: &mut Page<'_>, button: &str) -> (String, String) {
    page.ask(
        "window.savedFile = null;
         HTMLAnchorElement.prototype.click = function () { window.savedFile = [this.download, this.href]; };
         null",
    );
    page.ask(&format!("document.querySelector({button:?}).click(); null"));
    page.wait_until("window.savedFile");
    serde_json::from_value(page.ask("window.savedFile")).unwrap()
}

/// Every figure is saved as a drawing with its title, its legend and its scale, or as a bitmap.
#[test]
fn figures_are_saved() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let file = report(&made, THESIS, "thesis");
    let mut page = browser.open(&file, DARK);
    for id in figures(&mut page) {
        see(&mut page, &id);
        let (name, url) =
            saved(&mut page, &format!("#{id} [aria-label='Save this figure as SVG']"));
        assert!(name.starts_with(&id) && name.ends_with(".svg"), "{name}");
        let text =
            page.text(&format!("decodeURIComponent({:?}.split(',').slice(1).join(','))", url));
        let svg = roxmltree::Document::parse(&text).unwrap_or_else(|error| panic!("{id}: {error}"));
        let words: Vec<&str> = svg.descendants().filter_map(|node| node.text()).collect();
        let title = page.text(&format!("document.getElementById('{id}-title').textContent"));
        assert!(words.contains(&&*title), "{id}: {title} in {words:?}");
        let pressed = page.ask(&format!(
            "[...document.querySelectorAll('#{id} .legend button')].map(button => button.dataset.name)"
        ));
        for name in pressed.as_array().unwrap() {
            let name = name.as_str().unwrap();
            assert!(words.contains(&name), "{id}: {name} in {words:?}");
        }
        if let Some(path) = kept(&format!("saved-{id}"), "svg") {
            fs::write(path, &text).unwrap();
        }
        let (name, url) =
            saved(&mut page, &format!("#{id} [aria-label='Save this figure as PNG']"));
        assert!(name.ends_with(".png") && url.starts_with("data:image/png;base64,"), "{name}");
        assert!(url.len() > 20_000, "{id}: {} bytes", url.len());
    }
    // The page is unchanged.
    assert_eq!(page.text("String(document.documentElement.dataset.paper)"), "undefined");
    assert_eq!(page.faults(), [""; 0]);
}

/// Bars over uncertain parameters have tooltips, are reached by keys, and are hidden with their intervals.
#[test]
fn uncertain_parameters_have_bars_and_dots() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let mut page = browser.open(&report(&made, UNCERTAIN, "a"), LAPTOP);
    // The first figure is the answer: the residual vibration.
    assert_eq!(figures(&mut page)[0], "vibration");
    see(&mut page, "vibration");
    let median: Vec<f64> =
        dots(&mut page, "vibration", "median").iter().map(|dot| dot[1]).collect();
    let mut expected = made.numbers("a/points.parquet", "amplitude_p50_m");
    // The axis of the speed ascends.
    expected.reverse();
    for (found, expected) in median.iter().zip(&expected) {
        assert!((found - 1e6 * expected).abs() < 1e-3, "{found} {expected}");
    }
    let id = "rank-correlations";
    see(&mut page, id);
    page.ask(&format!("document.querySelector('#{id} .chart').focus()"));
    let mut told = Vec::new();
    for key in ["Home", "ArrowRight", "ArrowRight", "ArrowRight", "ArrowRight", "End"] {
        page.key(key);
        told.push(page.text(&format!("document.querySelector('#{id} .picked').textContent")));
    }
    for name in ["imbalance mass", "stiffness", "friction coefficient"] {
        let of_name = |told: &&String| told.contains(name) && told.contains("rank correlation");
        assert!(told.iter().any(|told| of_name(&told)), "{name}: {told:?}");
    }
    let series = format!("{}.getOption().series.length", chart(id));
    let before = page.number(&series);
    page.click_on(&format!("#{id} .legend button"));
    assert_eq!(page.number(&series), before - 2.0);

    let id = "drawn-parameters";
    see(&mut page, id);
    let labels = made.words("a/runs.parquet", "label");
    let points = made.numbers("a/runs.parquet", "point_id");
    let stiffness = made.numbers("a/runs.parquet", "stiffness_n_m");
    let amplitude = made.numbers("a/runs.parquet", "amplitude_m");
    choose(&mut page, id, 0, 0);
    choose(&mut page, id, 1, 0);
    let found = dots(&mut page, id, "equilibrium");
    let expected: Vec<[f64; 2]> = (0..labels.len())
        .filter(|run| points[*run] == 0.0 && labels[*run] == "equilibrium")
        .map(|run| [stiffness[run], 1e6 * amplitude[run]])
        .collect();
    assert!(!expected.is_empty() && found.len() == expected.len(), "{found:?} {expected:?}");
    for (found, expected) in found.iter().zip(&expected) {
        let off = (0..2).map(|axis| (found[axis] / expected[axis] - 1.0).abs());
        assert!(off.fold(0.0, f64::max) < 1e-6, "{found:?} {expected:?}");
    }
    assert_eq!(page.faults(), [""; 0]);
}

/// The pages of searches have no faults, on screens and on paper, and show the tables.
#[test]
fn searches_have_pages() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    for (directory, objectives, ids) in [
        ("one", "stop", &["convergence", "variables", "parallel-coordinates", "sobol-indices"][..]),
        (
            "two",
            "[stop, far]",
            &["convergence", "pareto", "variables", "parallel-coordinates", "sobol-indices"],
        ),
    ] {
        let file = search_page(&made, objectives, directory);
        for view in [LAPTOP, DARK, View { width: 390, ..LAPTOP }] {
            let mut page = browser.open(&file, view);
            assert_eq!(figures(&mut page), ids, "{directory}");
            in_words(&mut page);
            page.ask("scrollTo({top: 0, behavior: 'instant'})");
            page.screenshot(&format!("search-{directory}-{}-{}", view.width, view.dark));
            let (pale, texts) = page.pale();
            assert!(texts > 40 && pale.is_empty(), "{directory}: {texts} texts, {pale:?}");
            assert_eq!(page.nameless(), [], "{directory}");
            let over = page.overlapping();
            assert!(over.is_empty(), "{directory}, {} px: {over:?}", view.width);
            assert!(!page.wider_than_window(), "{directory}, {} px", view.width);
            assert_eq!(page.faults(), [""; 0], "{directory}");
        }
        let mut page = browser.open(&file, LAPTOP);
        see(&mut page, "convergence");
        let mut shown = dots(&mut page, "convergence", "meets all limits");
        shown.extend(dots(&mut page, "convergence", "does not meet all limits"));
        shown.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let stop = made.numbers(&format!("{directory}/evaluations.parquet"), "stop");
        let known: Vec<(usize, f64)> =
            stop.into_iter().enumerate().filter(|(_, value)| value.is_finite()).collect();
        assert_eq!(shown.len(), known.len());
        for (found, (design, value)) in shown.iter().zip(known) {
            assert_eq!(found[0], design as f64);
            assert!((found[1] - value).abs() <= 1e-6 * value.abs(), "{found:?} {value}");
        }
        let sheets = page.pdf(&format!("search-{directory}")).sheets();
        assert!((2..=ids.len() + 4).contains(&sheets), "{directory}: {sheets} sheets");
    }
}
