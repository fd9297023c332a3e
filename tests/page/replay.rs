//! `replay.html`: animation of disc and balls, by mouse and keys, in light and dark mode, and on
//! paper.

use std::path::PathBuf;

use super::browser::Browser;
use super::page::{DARK, LAPTOP, Page, View};
use super::results::Made;

/// With reduced motion, the animation does not start automatically.
const STILL: View = View { reduced_motion: true, ..LAPTOP };

/// Creates the replay of a run with this number of balls.
fn replay(made: &Made, balls: usize) -> PathBuf {
    replay_of(made, &format!("parameters: {{balls: {balls}}}"), 2)
}

/// Creates the replay of a run of a balancer with these keys.
fn replay_of(made: &Made, keys: &str, end_time_s: u32) -> PathBuf {
    made.write(
        "a.yaml",
        &format!(
            "schema: 1\nname: a\nseed: 5\nmodel: {{kind: ball_balancer, {keys}}}\n\
             initial_conditions: {{design: {{monte_carlo: {{samples: 1}}}}}}\n\
             simulation: {{end_time_s: {end_time_s}}}\n"
        ),
    );
    made.well("run a.yaml --out a");
    made.well("replay a 0");
    made.path("a-replay-0/replay.html")
}

/// Returns the positions of the balls in the window, px.
#[track_caller]
fn places(page: &mut Page<'_>) -> Vec<[f64; 2]> {
    let places = page.ask(
        r#"[...document.querySelectorAll('g[data-name^="ball "]')].map(ball => {
            const box = ball.querySelector('circle').getBoundingClientRect();
            return [box.x + box.width / 2, box.y + box.height / 2];
        })"#,
    );
    serde_json::from_value(places).unwrap()
}

fn apart(first: &[[f64; 2]], other: &[[f64; 2]]) -> f64 {
    let distance = |(a, b): (&[f64; 2], &[f64; 2])| (a[0] - b[0]).hypot(a[1] - b[1]);
    first.iter().zip(other).map(distance).fold(0.0, f64::max)
}

#[test]
fn a_replay_has_no_faults() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    for (balls, size) in [(1, 1280), (2, 1024), (8, 400)] {
        let file = replay(&made, balls);
        for view in [LAPTOP, DARK] {
            let mut page = browser.open(&file, View { width: size, ..view });
            page.wait_until("time > 0");
            page.click_on("#play");
            assert_eq!(page.faults(), [""; 0]);
            assert_eq!(places(&mut page).len(), balls);
            let (pale, texts) = page.pale();
            assert!(texts >= 8 + 2 * balls && pale.is_empty(), "{texts} texts, {pale:?}");
            assert_eq!(page.nameless(), []);
            assert!(!page.wider_than_window(), "{size} px");
            page.screenshot(&format!(
                "replay-{balls}-{}",
                if view.dark { "dark" } else { "light" }
            ));
        }
        std::fs::remove_dir_all(made.path("a")).unwrap();
        std::fs::remove_dir_all(made.path("a-replay-0")).unwrap();
    }
}

#[test]
fn a_replay_is_accessible() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let mut page = browser.open(&replay(&made, 2), STILL);
    let title = page.text("document.title");
    assert!(title.starts_with("a, run 0: "), "{title}");
    assert_eq!(page.text("document.querySelector('h1').textContent"), title);
    assert_eq!(page.text("document.documentElement.lang"), "en");
    let parts = page.accessible();
    for (role, name) in [
        ("RootWebArea", title.as_str()),
        ("heading", &title),
        ("image", "Machine"),
        ("button", "Play"),
        ("slider", "Time"),
        ("combobox", "Speed"),
        ("combobox", "View"),
        ("combobox", "Small motions ×"),
        ("list", "Contacts"),
    ] {
        let there = parts.iter().any(|part| part.role == role && part.name == name);
        assert!(there, "no {role} {name:?} in {parts:?}");
    }
    // A screen reader must not announce the time sixty times a second.
    assert_eq!(page.text("document.querySelector('output').ariaLive"), "off");
    page.key("End");
    let said = page.text("document.getElementById('time').getAttribute('aria-valuetext')");
    assert!(said.ends_with(" s of 2.0000 s") || said.contains(" of 1."), "{said}");
}

#[test]
fn balls_move_by_button_keys_and_slider() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let mut page = browser.open(&replay(&made, 2), STILL);
    let start = places(&mut page);
    page.frames(5);
    assert_eq!((page.number("time"), places(&mut page)), (0.0, start.clone()), "it waits");

    // By the button.
    page.click_on("#play");
    assert_eq!(page.text("document.getElementById('play').textContent"), "Pause");
    page.wait_until("time > 0.004");
    page.click_on("#play");
    let (time, stopped) = (page.number("time"), places(&mut page));
    assert!(apart(&start, &stopped) > 1.0, "{start:?} {stopped:?}");
    page.frames(5);
    assert_eq!((page.number("time"), places(&mut page)), (time, stopped));

    // By the space bar, with the focus on the button and without a focus.
    for _ in 0..2 {
        page.key("Space");
        assert_eq!(page.ask("playing"), true);
        page.key("Space");
        assert_eq!(page.ask("playing"), false);
        page.ask("document.activeElement.blur()");
    }

    // A frame forward and back, a hundred, the start and the end.
    page.key("Home");
    assert_eq!((page.number("time"), places(&mut page)), (0.0, start.clone()));
    let frame = page.number("data.seconds / (data.frames - 1)");
    for (key, frames) in [
        ("ArrowRight", 1.0),
        ("ArrowRight", 2.0),
        ("Shift+ArrowRight", 102.0),
        ("ArrowLeft", 101.0),
    ] {
        page.key(key);
        let at = page.number("time") / frame;
        assert!((at - frames).abs() < 1e-9, "{key}: frame {at}");
    }
    page.key("End");
    assert_eq!(page.number("time"), page.number("data.seconds"));

    // A click on the middle of the slider: the middle of the run.
    page.click_on("#time");
    let fraction = page.number("time / data.seconds");
    assert!((fraction - 0.5).abs() < 0.02, "{fraction}");
    assert_eq!(page.ask("playing"), false);

    // The drawing shows the data: an angle of the first ball, with the table drawn to scale.
    page.ask("byId('magnify').value = '1'; byId('frame').value = 'turning'; fit(); go(0); null");
    let centre = page.ask(
        "(() => { const box = document.querySelector('g[data-name=ring] circle').getBoundingClientRect();
          return [box.x + box.width / 2, box.y + box.height / 2]; })()",
    );
    let ball = places(&mut page)[0];
    let (right, up) =
        (ball[0] - centre[0].as_f64().unwrap(), centre[1].as_f64().unwrap() - ball[1]);
    let off = up.atan2(right) - page.number("data.quantities[2].values[0]");
    assert!(off.sin().abs() < 0.02 && off.cos() > 0.0, "{off} rad");
    // In space everything turns with the disc.
    page.ask("go(0.01); null");
    let turning = places(&mut page);
    page.ask("byId('frame').value = 'fixed'; draw(); null");
    assert!(apart(&turning, &places(&mut page)) > 10.0);
    assert_eq!(page.faults(), [""; 0]);
}

/// Balls that touch are marked where their circles meet; the button leads from impact to impact.
#[test]
fn a_replay_shows_contact() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let file = replay_of(&made, "contact: {}, parameters: {speed_rad_s: -173.1803}", 4);
    for view in [STILL, View { dark: true, ..STILL }] {
        let mut page = browser.open(&file, view);
        page.ask("window.marks = views[0].shapes.filter(({star}) => star); null");
        let all = page.number("impacts.length");
        assert!(all > 0.0, "no impact in this run");
        let seen = "marks.filter(({star}) => star.getAttribute('visibility') === 'visible').length";
        assert_eq!((page.number("time"), page.number(seen)), (0.0, 0.0));
        page.click_on("#next");
        assert_eq!((page.number("time"), page.number(seen)), (page.number("impacts[0]"), 1.0));
        assert_eq!(
            page.text("document.getElementById('count').textContent"),
            format!("Impacts: 1 of {all}")
        );
        page.ask("go(time + 2 * BURST); null");
        assert!(page.number("time") > page.number("impacts[1]") || page.number(seen) == 0.0);

        // The first frame in which balls touch: the dot lies on the edges of both circles.
        page.ask(
            "window.frame = Math.min(...contacts.map(({phases}) => phases.indexOf('c')).filter(place => place >= 0));
             go(data.seconds * frame / last); null",
        );
        assert!(page.number("frame") < page.number("data.frames"), "no contact that lasts");
        let off = page.ask(
            r#"(() => {
                const box = shape => shape.getBoundingClientRect();
                const mark = marks.find(({dot}) => dot.getAttribute('visibility') === 'visible');
                const centre = shape => [box(shape).x + box(shape).width / 2, box(shape).y + box(shape).height / 2];
                const dot = centre(mark.dot);
                return [...document.querySelectorAll('g[data-name^="ball "]')].map(ball => {
                    const circle = ball.querySelector('circle');
                    const [x, y] = centre(circle);
                    return Math.hypot(x - dot[0], y - dot[1]) / (box(circle).width / 2);
                });
            })()"#,
        );
        let off: Vec<f64> = serde_json::from_value(off).unwrap();
        assert!(off.len() == 2 && off.iter().all(|off| (off - 1.0).abs() < 0.1), "{off:?}");
        let states = page.text("document.getElementById('states').textContent");
        assert!(
            states.contains("balls 1 and 2: closed") || states.contains("balls 2 and 1: closed"),
            "{states}"
        );
        assert_eq!(page.ask("document.getElementById('contact').checkVisibility()"), true);
        let (pale, texts) = page.pale();
        assert!(texts > 8 && pale.is_empty(), "{texts} texts, {pale:?}");
        assert_eq!((page.faults(), page.nameless()), (vec![], vec![]));
        page.screenshot(&format!("replay-contact-{}", if view.dark { "dark" } else { "light" }));
    }
    // Balls without contact have none of this.
    let plain = Made::new();
    let mut page = browser.open(&replay(&plain, 2), STILL);
    for part in ["contact", "impacts"] {
        let seen = format!("document.getElementById('{part}').checkVisibility()");
        assert_eq!(page.ask(&seen), false, "{part}");
    }
}

/// The disc turns with the speed of its profile, whose plot marks kicks and the begin of the last stage.
#[test]
fn a_replay_shows_the_start_of_the_disc() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let keys = "speed_profile: [{ramp: {from_rad_s: -100, over_s: 0.5}}], \
                disturbances: [{kick: {at_s: 0.25, speed_m_s: 0.01, direction_rad: 0}}]";
    let file = replay_of(&made, keys, 2);
    for view in [STILL, View { dark: true, ..STILL }] {
        let mut page = browser.open(&file, view);
        assert_eq!(page.ask("document.getElementById('plots').checkVisibility()"), true);
        assert_eq!(page.ask("document.getElementById('stages').checkVisibility()"), true);
        let change = -116.3772;
        for time in [0.0_f64, 0.2, 0.5, 1.0] {
            let ramp = time.min(0.5);
            let speed = -100.0 + change * ramp / 0.5;
            let turned = -100.0 * ramp + change * ramp * ramp + (time - ramp) * (-100.0 + change);
            let found = page.number(&format!("disc({time}).speed"));
            assert!((found - speed).abs() < 1e-9, "{found} {speed}");
            let found = page.number(&format!("disc({time}).turned"));
            assert!((found - turned).abs() < 1e-9, "{found} {turned}");
        }
        // Each panel has both marks.
        for (mark, place) in [("kick", 0.25), ("last-stage", 0.5)] {
            let marks = format!("document.querySelectorAll('#plots .{mark}')");
            assert_eq!(page.number(&format!("{marks}.length")), 2.0);
            let box_of = |what: &str| format!("{what}.getBoundingClientRect()");
            let middle = |what: &str| {
                let shape = box_of(what);
                format!("({shape}.left + {shape}.right) / 2")
            };
            page.ask(&format!("go({place}); null"));
            let mark = page.number(&middle(&format!("{marks}[0]")));
            let now = page.number(&middle("marker"));
            assert!((mark - now).abs() < 1.0, "{mark} {now}");
        }
        let (pale, texts) = page.pale();
        assert!(texts > 12 && pale.is_empty(), "{texts} texts, {pale:?}");
        assert_eq!((page.faults(), page.nameless()), (vec![], vec![]));
        page.screenshot(&format!("replay-start-{}", if view.dark { "dark" } else { "light" }));
    }
    // A disc at constant speed has no plot of the speed.
    let plain = Made::new();
    let mut page = browser.open(&replay(&plain, 2), STILL);
    assert_eq!(page.number("document.querySelectorAll('#plots rect').length"), 1.0);
    assert_eq!(page.ask("document.getElementById('stages').checkVisibility()"), false);
}

/// A system with pictures, whose formulas have all functions.
const DRAWN: &str = r#"
schema: 1
name: a
seed: 5
model:
  system:
    system: a
    parameters: {b: 2, n: {value: 2, most: 3}, speed: 3}
    repeat: {k: n}
    turning: {theta: speed}
    coordinates:
      x[k]: {start: 0.3, start_rate: 1, enlarged: true}
      phi: {periodic: true, start: 1, start_rate: 9}
    motions: {push: {table: {columns: [time_s, push], rows: [[0, 0], [2, 4]]}}}
    mass: {"x[k]": {"x[k]": 1}, phi: {phi: 1}}
    force: {"x[k]": "-x[k] + cos(theta) + push"}
    contacts: {"foot[k]": {normal: 1, sliding: "x[k]'", friction: {coulomb: {coefficient: 0.1}}}}
    draw:
      top:
        turns: true
        shapes:
          rope:
            line:
              - ["x[1] - b * x[2] / 3", "-x[1]^2 + pi"]
              - ["sin(phi) + cos(phi) * tan(0.5)", "exp(x[1]) - log(b)"]
              - ["sqrt(b)^3 + tanh(x[2])", "atan(x[1]) + theta + theta' / 10"]
              - ["sum(k, k * x[k])", "if(n > 1, 4, 5) + push"]
          foot[k]: {circle: ["x[k]", k], radius: b / 8, contact: "foot[k]"}
initial_conditions: {design: {monte_carlo: {samples: 1}}}
simulation: {method: event, end_time_s: 2}
"#;

/// The pictures of a system file: the page computes all formulas as the program does, and enlarges small motions.
#[test]
fn a_replay_draws_a_system_of_a_file() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    made.write("a.yaml", DRAWN);
    made.well("run a.yaml --out a");
    made.well("replay a 0");
    let mut page = browser.open(&made.path("a-replay-0/replay.html"), STILL);
    for time in [0.0, 0.7, 2.0] {
        let numbers = |page: &mut Page<'_>, what: &str| -> Vec<f64> {
            serde_json::from_value(page.ask(what)).expect("numbers")
        };
        let q = numbers(&mut page, &format!("quantities({time}, 1)"));
        let [x, second, phi, push] = q[..] else { panic!("{q:?}") };
        let b = 2.0_f64;
        let expected = [
            x - b * second / 3.0,
            -x * x + std::f64::consts::PI,
            phi.sin() + phi.cos() * 0.5_f64.tan(),
            x.exp() - b.ln(),
            b.sqrt().powi(3) + second.tanh(),
            x.atan() + 3.0 * time + 0.3,
            x + 2.0 * second,
            4.0 + push,
        ];
        // A cubic polynomial between two rows, interpolated between two frames.
        assert!((push - time * time * (3.0 - time)).abs() < 1e-3, "{push}");
        let found = numbers(&mut page, &format!("valuesAt(ofViews[0], {time}, 1)[0]"));
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
        let enlarged = numbers(&mut page, &format!("valuesAt(ofViews[0], {time}, 10)[1]"));
        assert_eq!(enlarged, [10.0 * x, 1.0, 0.25]);
    }
    // The balancer's angle grows by 9 rad/s without a force, also beyond whole turns.
    let end = page.number("data.quantities[2].values.at(-1)");
    assert!((end - 19.0).abs() < 1e-3, "{end}");
    assert_eq!(page.number("document.querySelectorAll('.shapes > g').length"), 3.0);
    // The view at rest is turned back by the angle of the part that turns.
    let place = "new DOMMatrix(getComputedStyle(views[0].shapes[2].group).transform)";
    page.ask("byId('magnify').value = '1'; byId('frame').value = 'fixed'; fit(); go(0.7); null");
    let fixed = page.number(&format!("Math.atan2(-{place}.f, {place}.e)"));
    page.ask("byId('frame').value = 'turning'; draw(); null");
    let turning = page.number(&format!("Math.atan2(-{place}.f, {place}.e)"));
    assert!((turning - fixed + 2.1).sin().abs() < 1e-5, "{fixed} {turning}");
    assert_eq!((page.faults(), page.nameless()), (vec![], vec![]));
    page.screenshot("replay-system");
}

#[test]
fn a_replay_can_be_printed() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let file = replay(&made, 3);
    for dark in [false, true] {
        let mut page = browser.open(&file, View { dark, ..STILL });
        assert_eq!(page.pdf(&format!("replay-{dark}")).sheets(), 1);
        page.view(View { dark, print: true, ..STILL });
        let seen = "!!document.querySelector(selector).checkVisibility()";
        for (selector, expected) in [("svg", true), ("output", true), ("button", false)] {
            assert_eq!(page.ask(&seen.replace("selector", &format!("{selector:?}"))), expected);
        }
        assert_eq!(
            page.text("getComputedStyle(document.body).backgroundColor"),
            "rgb(255, 255, 255)"
        );
        let (pale, texts) = page.pale();
        assert!(texts > 5 && pale.is_empty(), "{texts} texts, {pale:?}");
        page.screenshot(&format!("replay-print-{dark}"));
    }
}

/// The picture is saved as a drawing that has its colours without the page's style, or as a bitmap.
#[test]
fn the_picture_is_saved() {
    let Some(mut browser) = Browser::start() else { return };
    let made = Made::new();
    let mut page = browser.open(&replay(&made, 2), STILL);
    page.ask(
        "window.savedFile = null;
         HTMLAnchorElement.prototype.click = function () { window.savedFile = [this.download, this.href]; };
         null",
    );
    page.click_on("#svg");
    page.wait_until("window.savedFile");
    let name = page.text("savedFile[0]");
    assert!(name.starts_with("a-run-0-") && name.ends_with("-0.0000-s.svg"), "{name}");
    let text = page.text("decodeURIComponent(savedFile[1].split(',').slice(1).join(','))");
    let svg = roxmltree::Document::parse(&text).unwrap();
    let circles = svg.descendants().filter(|node| node.has_tag_name("circle"));
    assert!(circles.count() >= 4);
    assert!(!text.contains("var(") || text.contains("fill=\"rgb("), "{text}");
    page.ask("savedFile = null");
    page.click_on("#png");
    page.wait_until("window.savedFile");
    let (name, url) = (page.text("savedFile[0]"), page.text("savedFile[1]"));
    assert!(name.ends_with(".png") && url.starts_with("data:image/png;base64,"), "{name}");
    assert!(url.len() > 5_000, "{} bytes", url.len());
    assert_eq!(page.faults(), [""; 0]);
}
