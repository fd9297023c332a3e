//! A scene as SVG.

use std::fmt::Write;

use super::scene::{Anchor, Box2, Item, Paint, Scene, Step, Stroke};
use crate::foreign::is_acted_on;
use crate::report::chart::Figure;
use crate::table::VERSION;

/// Fonts by preference: the one whose widths are known, then what is on most machines.
const FAMILY: &str = "'DejaVu Sans', Verdana, 'Bitstream Vera Sans', Arial, sans-serif";

/// A number with the decimals that paper shows: a two-hundredth of a point.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// Text in an SVG document: without what XML does not know.
pub fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\n' => safe.push('\n'),
            '\u{fffe}' | '\u{ffff}' => safe.push(' '),
            letter if is_acted_on(letter) => safe.push(' '),
            letter => safe.push(letter),
        }
    }
    safe
}

fn data(steps: &[Step]) -> String {
    let mut data = String::new();
    for step in steps {
        // Writing into a string cannot fail.
        let _ = match *step {
            Step::Move([x, y]) => write!(data, "M{} {}", number(x), number(y)),
            Step::Line([x, y]) => write!(data, "L{} {}", number(x), number(y)),
            Step::Close => write!(data, "Z"),
            Step::Point([x, y]) => write!(data, "M{} {}h.01", number(x), number(y)),
            Step::Circle([x, y], radius) => {
                let (r, d) = (number(radius), number(2.0 * radius));
                let begin = number(x - radius);
                write!(data, "M{begin} {}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0-{d} 0Z", number(y))
            }
        };
    }
    data
}

fn hex(paint: Paint) -> String {
    let [red, green, blue] = paint.rgb;
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn stroke(text: &mut String, stroke: &Stroke) {
    let Stroke { paint, width, dash } = stroke;
    let _ = write!(text, " stroke=\"{}\" stroke-width=\"{}\"", hex(*paint), number(*width));
    if paint.opacity < 1.0 {
        let _ = write!(text, " stroke-opacity=\"{}\"", number(paint.opacity));
    }
    if dash.is_empty() {
        text.push_str(" stroke-linecap=\"round\"");
    } else {
        let dashes: Vec<String> = dash.iter().map(|length| number(*length)).collect();
        let _ = write!(text, " stroke-dasharray=\"{}\"", dashes.join(" "));
    }
    text.push_str(" stroke-linejoin=\"round\"");
}

/// The document: the scene with the figure's words.
pub fn svg(scene: &Scene, figure: &Figure) -> String {
    let [width, height] = scene.size;
    let millimetres = |points: f64| number(points / 72.0 * 25.4);
    let id = escaped(&figure.id);
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- made by stickslip {VERSION} -->\n\
         <svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}mm\" height=\"{}mm\" \
         viewBox=\"0 0 {} {}\" role=\"img\" aria-labelledby=\"{id}-title {id}-desc\">\n\
         <title id=\"{id}-title\">{}</title>\n<desc id=\"{id}-desc\">{}\n{}</desc>\n",
        millimetres(width),
        millimetres(height),
        number(width),
        number(height),
        escaped(&figure.title),
        escaped(&figure.alternative),
        escaped(&figure.caption),
    );
    let clips: Vec<Box2> = clips(scene);
    if !clips.is_empty() {
        text.push_str("<defs>\n");
        for (index, area) in clips.iter().enumerate() {
            let _ = writeln!(
                text,
                "<clipPath id=\"{id}-clip-{index}\"><path d=\"{}\"/></clipPath>",
                data(&area.steps())
            );
        }
        text.push_str("</defs>\n");
    }
    let _ = writeln!(text, "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>");
    let _ = writeln!(text, "<g font-family=\"{FAMILY}\" fill=\"#000000\">");
    for item in &scene.items {
        match item {
            Item::Path { steps, fill, stroke: line, clip } => {
                let _ = write!(text, "<path d=\"{}\"", data(steps));
                match fill {
                    None => text.push_str(" fill=\"none\""),
                    Some(paint) => {
                        let _ = write!(text, " fill=\"{}\"", hex(*paint));
                        if paint.opacity < 1.0 {
                            let _ = write!(text, " fill-opacity=\"{}\"", number(paint.opacity));
                        }
                    }
                }
                if let Some(line) = line {
                    stroke(&mut text, line);
                }
                let place = clip.and_then(|clip| clips.iter().position(|one| *one == clip));
                if let Some(index) = place {
                    let _ = write!(text, " clip-path=\"url(#{id}-clip-{index})\"");
                }
                text.push_str("/>\n");
            }
            Item::Text { at: [x, y], size, anchor, turned, words } => {
                let (x, y) = (number(*x), number(*y));
                let _ = write!(text, "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\"", number(*size));
                text.push_str(match anchor {
                    Anchor::Start => "",
                    Anchor::Middle => " text-anchor=\"middle\"",
                    Anchor::End => " text-anchor=\"end\"",
                });
                if *turned != 0.0 {
                    let _ = write!(text, " transform=\"rotate({} {x} {y})\"", number(*turned));
                }
                let _ = writeln!(text, ">{}</text>", escaped(words));
            }
        }
    }
    text.push_str("</g>\n</svg>\n");
    text
}

/// All that anything is clipped by.
fn clips(scene: &Scene) -> Vec<Box2> {
    let mut found: Vec<Box2> = Vec::new();
    for item in &scene.items {
        if let Item::Path { clip: Some(clip), .. } = item
            && !found.contains(clip)
        {
            found.push(*clip);
        }
    }
    found
}
