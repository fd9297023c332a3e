//! `replay.svg`, read as what it is made of: its curves are those of `trajectory.parquet`, and its words
//! can be read.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::fs;

use roxmltree::{Document, Node};

use crate::cli::support::{Scratch, numbers, study_text, words};

/// The colours of balls.
const BALLS: [&str; 8] =
    ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#464646", "#785E1E"];
const LIMIT: &str = "#787878";
const STUCK: &str = "#DEDEDE";

/// One pixel of the figure, in the units of its drawing.
const PIXEL: f64 = 4.0;

fn number(node: Node<'_, '_>, name: &str) -> f64 {
    node.attribute(name).unwrap_or_else(|| panic!("no {name}")).parse().unwrap()
}

/// Where a part of the figure begins.
fn corner(part: Node<'_, '_>) -> [f64; 2] {
    let moved = part.attribute("transform").unwrap();
    let numbers = moved.trim_start_matches("translate(").trim_end_matches(')').split(' ');
    let numbers: Vec<f64> = numbers.map(|number| number.parse().unwrap()).collect();
    [numbers[0], numbers[1]]
}

#[track_caller]
fn part<'a, 'i>(picture: &'a Document<'i>, id: &str) -> Node<'a, 'i> {
    let found = picture.descendants().find(|node| node.attribute("id") == Some(id));
    found.unwrap_or_else(|| panic!("no {id}"))
}

fn points(curve: Node<'_, '_>) -> Vec<[f64; 2]> {
    let pairs = curve.attribute("points").unwrap().split_whitespace();
    let pair = |pair: &str| {
        let (x, y) = pair.split_once(',').unwrap();
        [x.parse().unwrap(), y.parse().unwrap()]
    };
    pairs.map(pair).collect()
}

/// The curves of a part that have a colour: those are thicker than the lines of labels are long.
fn curves(part: Node<'_, '_>, colour: &str) -> Vec<Vec<[f64; 2]>> {
    let of_colour = |node: &Node<'_, '_>| {
        node.has_tag_name("polyline") && node.attribute("stroke") == Some(colour)
    };
    let all = part.children().filter(of_colour).map(points);
    all.filter(|points| points[0][0] <= RIGHT).collect()
}

/// Right end of the axes of time; labels of curves lie beyond.
const RIGHT: f64 = PIXEL * 866.0;

fn text(node: Node<'_, '_>) -> String {
    node.text().unwrap_or_default().trim().replace('−', "-")
}

/// How values of a panel lie on its ordinate, from the numbers beside it: the value at 0 and that of a unit
/// of the drawing.
#[track_caller]
fn ordinate(part: Node<'_, '_>) -> impl Fn(f64) -> f64 + use<> {
    let beside = part
        .children()
        .filter(|node| node.has_tag_name("text") && node.attribute("text-anchor") == Some("end"));
    let angle = |text: &str| match text {
        "π/2" => Some(TAU / 4.0),
        "π" => Some(TAU / 2.0),
        "3π/2" => Some(0.75 * TAU),
        "2π" => Some(TAU),
        _ => None,
    };
    let ticks: Vec<(f64, f64)> = beside
        .map(|node| {
            let text = text(node);
            let value = angle(&text).unwrap_or_else(|| text.parse().unwrap());
            (value, number(node, "y"))
        })
        .collect();
    let ((v0, y0), (v1, y1)) = (ticks[0], ticks[ticks.len() - 1]);
    assert!(v0 != v1, "{ticks:?}");
    move |value| y0 + (value - v0) / (v1 - v0) * (y1 - y0)
}

/// A study of one run, and its replay with these options.
fn replayed(scratch: &Scratch, end_time_s: f64, rest: &str, options: &str) -> String {
    let text = study_text("a", "{monte_carlo: {samples: 1}}", end_time_s, rest);
    scratch.write("a.yaml", text);
    let _ = fs::remove_dir_all(scratch.path("a"));
    let _ = fs::remove_dir_all(scratch.path("a-replay-0"));
    scratch.stickslip("run a.yaml --out a");
    scratch.well(&format!("replay a 0 {options}"));
    fs::read_to_string(scratch.path("a-replay-0/replay.svg")).unwrap()
}

/// The ends of all curves are those of the motion, within a pixel.
#[test]
fn curves_are_those_of_the_trajectory() {
    let scratch = Scratch::new();
    for balls in [1, 2, 8] {
        let model = format!("model: {{kind: ball_balancer, parameters: {{balls: {balls}}}}}\n");
        let picture = replayed(&scratch, 0.5, &model, "");
        let picture = Document::parse(&picture).unwrap();
        let rows = scratch.table("a-replay-0", "trajectory");
        let of = |name: &str| -> Vec<f64> { numbers(&rows, name).into_iter().flatten().collect() };
        let last = |name: &str| *of(name).last().unwrap();
        let near = |part: &str, curve: &[[f64; 2]], [first, last]: [f64; 2]| {
            let at = ordinate(self::part(&picture, part));
            let ends = [(curve[0], first), (curve[curve.len() - 1], last)];
            for ([_, y], value) in ends {
                assert!((y - at(value)).abs() <= PIXEL, "{part}: {y}, not {} ({value})", at(value));
            }
        };
        for ball in 1..=balls {
            let colour = BALLS[ball - 1];
            for (part, column, factor) in [
                ("speed".to_owned(), format!("ball_speed_{ball}_rad_s"), 1.0),
                (format!("friction-{ball}"), format!("friction_{ball}_n"), 1e3),
            ] {
                let values = of(&column);
                let found = curves(self::part(&picture, &part), colour);
                assert_eq!(found.len(), 1, "{part} of {balls} balls");
                let ends = [values[0], values[values.len() - 1]].map(|value| factor * value);
                near(&part, &found[0], ends);
                let [first, end] = [found[0][0][0], found[0][found[0].len() - 1][0]];
                assert!((first - PIXEL * 64.0).abs() <= PIXEL && (end - RIGHT).abs() <= PIXEL);
            }
            // A curve for each turn.
            let turns: Vec<f64> = of(&format!("beta_unwrapped_{ball}_rad"))
                .into_iter()
                .map(|angle| (angle / TAU).floor())
                .collect();
            let turns = 1 + turns.windows(2).filter(|pair| pair[0] != pair[1]).count();
            let angles = curves(self::part(&picture, "angle"), colour);
            assert_eq!(angles.len(), turns, "ball {ball} of {balls}");
            let wrapped = of(&format!("beta_{ball}_rad"));
            let (first, end) = (&angles[0], &angles[turns - 1]);
            near("angle", &first[..1], [wrapped[0]; 2]);
            near("angle", &end[end.len() - 1..], [wrapped[wrapped.len() - 1]; 2]);
            // The limit of friction, above and below.
            let friction = format!("friction-{ball}");
            let limits = curves(self::part(&picture, &friction), LIMIT);
            let limit = format!("friction_limit_{ball}_n");
            assert_eq!(limits.len(), 2);
            near(&friction, &limits[0], [1e3 * of(&limit)[0], 1e3 * last(&limit)]);
            near(&friction, &limits[1], [-1e3 * of(&limit)[0], -1e3 * last(&limit)]);
        }
        let away = |k: usize| 1e3 * of("x_m")[k].hypot(of("y_m")[k]);
        let table = curves(part(&picture, "displacement"), "#3C3C3C");
        assert_eq!(table.len(), 1);
        near("displacement", &table[0], [away(0), away(rows.num_rows() - 1)]);
        for (id, x, y) in
            [("path-disc", "x_m", "y_m"), ("path-space", "x_inertial_m", "y_inertial_m")]
        {
            let dot = part(&picture, id).children().find(|node| node.has_tag_name("circle"));
            let dot = dot.unwrap();
            let at = ordinate(part(&picture, id))(1e3 * last(y));
            assert!((number(dot, "cy") - at).abs() <= PIXEL, "{id} {x}");
        }
    }
}

/// What is shaded are the times between the switches to stick and from it.
#[test]
fn a_contact_that_sticks_is_shaded() {
    let scratch = Scratch::new();
    let rest = "model: {kind: block_on_belt, parameters: {belt_speed_m_s: 0.1}, friction: {stribeck: \
                {static_friction_coefficient: 0.2, stribeck_speed_m_s: 0}}}\n";
    let picture = replayed(&scratch, 5.0, rest, "");
    let picture = Document::parse(&picture).unwrap();
    let switches = scratch.table("a-replay-0", "switches");
    let (times, after) = (numbers(&switches, "time_s"), words(&switches, "to"));
    let end =
        numbers(&scratch.table("a-replay-0", "trajectory"), "time_s").pop().flatten().unwrap();
    let x = |time: f64| PIXEL * 64.0 + time / end * (RIGHT - PIXEL * 64.0);
    let mut expected = Vec::new();
    for (index, phase) in after.iter().enumerate() {
        let until = times.get(index + 1).map_or(end, |time| time.unwrap());
        if phase.as_deref() == Some("stick") && until > times[index].unwrap() {
            expected.push([x(times[index].unwrap()), x(until)]);
        }
    }
    let shaded = part(&picture, "friction")
        .children()
        .filter(|node| node.has_tag_name("rect") && node.attribute("fill") == Some(STUCK));
    let shaded: Vec<[f64; 2]> =
        shaded.map(|node| [number(node, "x"), number(node, "x") + number(node, "width")]).collect();
    assert!(!expected.is_empty());
    assert_eq!(shaded.len(), expected.len(), "{shaded:?} {expected:?}");
    for (shaded, expected) in shaded.iter().zip(&expected) {
        let off = (0..2).map(|end| (shaded[end] - expected[end]).abs()).fold(0.0, f64::max);
        assert!(off <= PIXEL, "{shaded:?} {expected:?}");
    }
}

/// Words: all inside of the picture, none upon another, and enough for whoever cannot see it.
#[test]
fn a_figure_can_be_read() {
    let scratch = Scratch::new();
    let heavy = "model: {kind: ball_balancer, parameters: {table_mass_kg: 2.0e-2, ball_mass_kg: \
                 1.5e-1, speed_rad_s: -60, friction_coefficient: 3}}\n";
    let eight = "model: {kind: ball_balancer, parameters: {balls: 8}}\n";
    let free = "model: {kind: block_on_spring, parameters: {friction_coefficient: 0}}\n";
    for (name, end_time_s, rest, options) in [
        ("two balls", 2.0, "", ""),
        ("part", 2.0, "", "--times 0.1:0.11:20"),
        ("very short", 1e-5, "", ""),
        ("fails", 1.0, heavy, ""),
        ("eight balls", 4.0, eight, ""),
        ("no friction", 20.0, free, ""),
    ] {
        let picture = replayed(&scratch, end_time_s, rest, options);
        assert!(picture.len() < 400_000, "{name}: {} bytes", picture.len());
        assert!(!picture.contains("NaN") && !picture.contains("inf"), "{name}");
        let picture = Document::parse(&picture).unwrap();
        let root = picture.root_element();
        assert_eq!(root.attribute("role"), Some("img"));
        let named = root.attribute("aria-labelledby").unwrap().split(' ');
        let named: Vec<String> = named.map(|id| text(part(&picture, id))).collect();
        assert!(named[0].starts_with("a, run 0: "), "{name}: {named:?}");
        assert!(named[1].contains("Over time from ") && named[1].contains("At the end"));

        let view: Vec<f64> = root
            .attribute("viewBox")
            .unwrap()
            .split(' ')
            .map(|number| number.parse().unwrap())
            .collect();
        let mut boxes: Vec<([f64; 4], String)> = Vec::new();
        for node in picture.descendants().filter(|node| node.has_tag_name("text")) {
            let words = text(node);
            if words.is_empty() {
                continue;
            }
            let [left, top] = corner(node.parent_element().unwrap());
            let (x, y) = (left + number(node, "x"), top + number(node, "y"));
            // Letters are hardly wider than this on average, in any font without serifs.
            let size = number(node, "font-size");
            let width = 0.62 * size * words.chars().count() as f64;
            let before = match node.attribute("text-anchor") {
                Some("end") => width,
                Some("middle") => width / 2.0,
                _ => 0.0,
            };
            // Words hang from their place, are level with it, or stand on it.
            let above = match node.attribute("dy") {
                Some("0.76em") => 0.0,
                Some("0.5ex") => size / 2.0,
                Some("-0.5ex") => size,
                other => panic!("{name}: {other:?}"),
            };
            let corners = [x - before, y - above, x - before + width, y - above + 0.9 * size];
            assert!(
                corners[0] >= 0.0
                    && corners[1] >= 0.0
                    && corners[2] <= view[2]
                    && corners[3] <= view[3],
                "{name}: {words:?} at {corners:?} of {view:?}"
            );
            for (other, others) in &boxes {
                let apart = corners[0] >= other[2]
                    || other[0] >= corners[2]
                    || corners[1] >= other[3]
                    || other[1] >= corners[3];
                assert!(apart, "{name}: {words:?} at {corners:?} upon {others:?} at {other:?}");
            }
            boxes.push((corners, words));
        }
        assert!(boxes.len() > 10, "{name}: {boxes:?}");
    }
}

/// Legends name what is there: each ball, at its curves too, the limit of friction, and sticking.
#[test]
fn a_legend_names_what_is_there() {
    let scratch = Scratch::new();
    let rest = "model: {kind: ball_balancer, parameters: {balls: 3}}\n";
    let picture = replayed(&scratch, 4.0, rest, "");
    let picture = Document::parse(&picture).unwrap();
    let words = |id: &str| -> Vec<String> {
        let texts = part(&picture, id).children().filter(|node| node.has_tag_name("text"));
        texts.map(text).collect()
    };
    let legend = words("heading");
    for expected in
        ["ball 1", "ball 2", "ball 3", "± the most that friction can hold", "the ball sticks"]
    {
        assert!(legend.iter().any(|words| words == expected), "no {expected:?} in {legend:?}");
    }
    for id in ["angle", "speed"] {
        let numbers: Vec<String> = words(id);
        let at_curves = &numbers[numbers.len() - 3..];
        let sorted: BTreeMap<&String, ()> = at_curves.iter().map(|word| (word, ())).collect();
        assert_eq!(sorted.into_keys().collect::<Vec<_>>(), ["1", "2", "3"], "{id}");
    }
    for ball in 1..=3 {
        let title = format!("friction on ball {ball} [mN]");
        assert_eq!(words(&format!("friction-{ball}"))[0], title);
    }
}

/// A ball that runs for ever makes as many turns as it likes: the picture stays small.
#[test]
fn long_runs_make_no_large_pictures() {
    let scratch = Scratch::new();
    let rest = "model: {kind: ball_balancer, parameters: {speed_rad_s: -260, friction_coefficient: \
                1.0e-5}}\n";
    let sizes = [2.0, 30.0].map(|end_time_s| replayed(&scratch, end_time_s, rest, "").len());
    assert!(sizes[1] < 300_000, "{sizes:?}");
    let picture = fs::read_to_string(scratch.path("a-replay-0/replay.svg")).unwrap();
    assert!(picture.contains("pale: turns too short to be told apart"));
}

/// The same bytes for the same run, however it was computed.
#[test]
fn pictures_are_the_same_bytes() {
    let scratch = Scratch::new();
    let text = study_text("a", "{monte_carlo: {samples: 9}}", 0.5, "");
    scratch.write("a.yaml", text);
    let files = ["replay.svg", "replay.html", "trajectory.parquet", "switches.parquet"];
    let made = [1, 2].map(|threads| {
        scratch.well(&format!("run a.yaml --out a{threads} --threads {threads}"));
        scratch.well(&format!("replay a{threads} 7"));
        files.map(|file| fs::read(scratch.path(&format!("a{threads}-replay-7/{file}"))).unwrap())
    });
    assert!(made[0] == made[1]);
    scratch.well("replay a1 7 --out again");
    let again = files.map(|file| fs::read(scratch.path(&format!("again/{file}"))).unwrap());
    assert!(made[0] == again);
}
