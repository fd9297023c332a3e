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
use crate::study::Study;
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
    let mut body = Html::default();
    body.line("<header>");
    body.element("h1", "", data.study.name());
    tables::facts(&mut body, data);
    tables::warnings(&mut body, directory, data);
    let before = [("points", "Points"), ("responses", "Responses")];
    let before = &before[..1 + usize::from(!data.study.responses().is_empty())];
    let after = [("notable", "List of failed and flipped runs"), ("study", "Study")];
    links(&mut body, before, figures, &after);
    conclusion::conclusion(&mut body, data);
    points::points(&mut body, directory, data);
    drawn_figures(&mut body, figures);
    tables::other_parameters(&mut body, data);
    tables::notable(&mut body, directory, data);
    let place = shown_path(&directory.join("study.yaml"));
    assembled(data.study, &place, directory, body, figures)
}

/// Adds all figures.
fn drawn_figures(body: &mut Html, figures: &[Figure]) {
    body.line("<div id=\"figures\">");
    body.line(
        "<p class=\"hint soft\">Press a name to hide or show a series; Ctrl and the wheel zoom, dragging \
         moves; a click on a dot pins its data.</p>",
    );
    for Figure { id, title, caption, alternative, .. } in figures {
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
    body.line("</div>");
}

/// Ends the header, adds links to the parts of the page, and begins the main part. The figures are between the parts before
/// and the other parts.
fn links(body: &mut Html, before: &[(&str, &str)], figures: &[Figure], after: &[(&str, &str)]) {
    body.line("</header>\n<nav aria-label=\"Parts of this page\"><ul>");
    let mut link = |id: &str, title: &str| {
        body.line(&format!("<li><a href=\"#{id}\">{}</a></li>", escaped(title)));
    };
    before.iter().for_each(|(id, title)| link(id, title));
    figures.iter().for_each(|figure| link(&format!("{}-title", figure.id), &figure.title));
    after.iter().for_each(|(id, title)| link(id, title));
    body.line("</ul></nav>\n<main>");
}

/// Returns the whole page with this body, to which the study file is added, or the place of a long one.
fn assembled(
    study: &Study,
    place: &str,
    directory: &Path,
    mut body: Html,
    figures: &[Figure],
) -> String {
    body.line("<section aria-labelledby=\"study\"><h2 id=\"study\">Study</h2>");
    let file = study.resolved_yaml();
    if file.len() <= MOST_STUDY {
        body.line("<details><summary>Study file with all defaults</summary>");
        body.element("pre", "", &file);
        body.line("</details></section>\n</main>");
    } else {
        body.line(&format!(
            "<p>The study file is too long to show: see {}.</p></section>\n</main>",
            escaped(place)
        ));
    }
    let data = json!({
        "directory": shell_word(directory),
        "figures": figures,
    });
    // Escaping `<` keeps data from ending the script element that holds it.
    let data = harmless_json(&data.to_string()).replace('<', "\\u003c");
    let parts = [
        ("<!--title-->", escaped(&format!("{}: stickslip report", study.name()))),
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

#[cfg(test)]
mod tests {
    use super::fill;

    #[test]
    fn what_is_put_in_is_not_looked_at_again() {
        let parts = [("<!--a-->", "<!--b-->".to_owned()), ("<!--b-->", "2".to_owned())];
        assert_eq!(fill("1 <!--a--> <!--b--> 3", &parts), "1 <!--b--> 2 3");
    }
}
