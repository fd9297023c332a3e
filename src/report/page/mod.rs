//! The report as one HTML page: facts of the run, the table of points, and interactive figures.
//!
//! The file contains style, script, the charting library (Apache ECharts, see `assets/echarts-LICENSE`) and the
//! data. Its content security policy forbids all network requests.
//!
//! Read `html` first. `conclusion`, `tables` and `points` write the parts of the page of a study, which [`page`] combines,
//! and `optimum` writes the page of a search.

mod conclusion;
mod html;
mod optimum;
mod points;
mod tables;

use std::path::Path;

use serde_json::json;

use super::chart::Figure;
use super::data::ReportData;
use crate::sanitize::{harmless_json, shell_word, shown_path};
use html::{Html, escaped};
pub use optimum::optimum_page;

const PAGE: &str = include_str!("assets/page.html");
const STYLE: &str = include_str!("assets/page.css");
const SCRIPT: &str = include_str!("assets/page.js");
const LIBRARY: &str = include_str!("assets/echarts.min.js");

/// Marks a file as a page of this program, which the program may replace.
pub const OWN: &str = "<meta name=\"generator\" content=\"stickslip\">";

/// The longest study file that the page shows, in bytes.
const MOST_STUDY: usize = 60_000;

/// Returns the page of a directory of results.
pub fn page(directory: &Path, data: &ReportData<'_>, figures: &[Figure]) -> String {
    let name = data.study.name();
    let mut body = Html::default();
    body.line("<header>");
    body.element("h1", "", name);
    tables::facts(&mut body, data);
    tables::warnings(&mut body, directory, data);
    body.line("</header>");
    body.line("<nav aria-label=\"Parts of this page\"><ul>");
    body.line("<li><a href=\"#points\">Points</a></li>");
    if !data.study.responses().is_empty() {
        body.line("<li><a href=\"#responses\">Responses</a></li>");
    }
    for figure in figures {
        body.line(&format!(
            "<li><a href=\"#{}-title\">{}</a></li>",
            figure.id,
            escaped(&figure.title)
        ));
    }
    body.line("<li><a href=\"#notable\">List of failed and flipped runs</a></li>");
    body.line("<li><a href=\"#study\">Study</a></li>");
    body.line("</ul></nav>\n<main>");
    conclusion::conclusion(&mut body, data);
    points::points(&mut body, directory, data);
    drawn_figures(&mut body, figures);
    tables::other_parameters(&mut body, data);
    tables::notable(&mut body, directory, data);
    study_section(
        &mut body,
        &data.study.resolved_yaml(),
        &shown_path(&directory.join("study.yaml")),
    );
    assembled(name, directory, body, figures)
}

/// Adds all figures.
fn drawn_figures(body: &mut Html, figures: &[Figure]) {
    body.line("<div id=\"figures\">");
    body.line(
        "<p class=\"hint soft\">Press a name to hide or show a series; Ctrl and the wheel zoom, dragging \
         moves; a click on a dot pins its data.</p>",
    );
    for figure in figures {
        section(body, figure);
    }
    body.line("</div>");
}

/// Adds the study file, or the place of a long one, and ends the main part.
fn study_section(body: &mut Html, study: &str, place: &str) {
    body.line("<section aria-labelledby=\"study\"><h2 id=\"study\">Study</h2>");
    if study.len() <= MOST_STUDY {
        body.line("<details><summary>Study file with all defaults</summary>");
        body.element("pre", "", study);
        body.line("</details></section>\n</main>");
    } else {
        body.line(&format!(
            "<p>The study file is too long to show: see {}.</p></section>\n</main>",
            escaped(place)
        ));
    }
}

/// Returns the whole page with a title and this body.
fn assembled(name: &str, directory: &Path, body: Html, figures: &[Figure]) -> String {
    let data = json!({
        "directory": shell_word(directory),
        "figures": figures,
    });
    // Escaping `<` keeps data from ending the script element that holds it.
    let data = harmless_json(&data.to_string()).replace('<', "\\u003c");
    let parts = [
        ("<!--title-->", escaped(&format!("{name}: stickslip report"))),
        ("<!--style-->", STYLE.to_owned()),
        ("<!--body-->", body.text()),
        ("<!--data-->", data),
        ("<!--library-->", LIBRARY.to_owned()),
        ("<!--script-->", SCRIPT.to_owned()),
    ];
    fill(PAGE, &parts)
}

/// Replaces each mark by its text, in order; does not search inserted texts for marks.
fn fill(page: &str, parts: &[(&str, String)]) -> String {
    let mut filled = String::new();
    let mut rest = page;
    for (mark, text) in parts {
        if let Some((before, after)) = rest.split_once(mark) {
            filled += before;
            filled += text;
            rest = after;
        }
    }
    filled + rest
}

fn section(body: &mut Html, figure: &Figure) {
    let Figure { id, title, caption, alternative, .. } = figure;
    body.line(&format!("<section aria-labelledby=\"{id}-title\">"));
    body.line(&format!("<h2 id=\"{id}-title\">{}</h2>", escaped(title)));
    body.line(&format!("<figure id=\"{id}\"><figcaption>{}", escaped(caption)));
    if !alternative.is_empty() {
        body.line("<details><summary>Text version</summary>");
        body.element("p", &format!(" id=\"{id}-words\""), alternative);
        body.line("</details>");
    }
    body.line("</figcaption></figure>\n</section>");
}

#[cfg(test)]
mod tests {
    use super::fill;

    #[test]
    fn what_is_put_in_is_not_looked_at_again() {
        let parts = [("<!--a-->", "<!--b-->".to_owned()), ("<!--b-->", "2".to_owned())];
        assert_eq!(fill("1 <!--a--> <!--b--> 3", &parts), "1 <!--b--> 2 3");
    }
}
