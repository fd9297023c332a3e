//! SVG that any program can read, PNG of the right size, and the same bytes every time.

use roxmltree::{Document, Node};
use stickslip::report::chart::{Figure, Mark};
use stickslip::report::figures::sets;
use stickslip::report::paper::{Format, sheets};

use super::{everything, shipped};

fn svg(figure: &Figure) -> Vec<String> {
    let sheets = sheets(figure).into_iter();
    sheets.map(|(_, sheet)| String::from_utf8(sheet.file(Format::Svg).unwrap()).unwrap()).collect()
}

fn figures() -> Vec<Figure> {
    let mut figures = vec![everything()];
    figures.extend(sets(&shipped("equilibrium-set")));
    figures.extend(sets(&shipped("equilibrium-speed")));
    figures
}

fn number(node: &Node<'_, '_>, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

/// The numbers of a path.
fn numbers(data: &str) -> Vec<f64> {
    let spaced = data.replace('-', " -").replace(|c: char| c.is_ascii_alphabetic(), " ");
    spaced.split_whitespace().map(|text| text.parse().unwrap()).collect()
}

/// Widths of letters of DejaVu Sans over its height, on the average of words.
const WIDE: f64 = 0.52;

#[test]
fn svg_is_whole_and_words_are_inside() {
    for figure in figures() {
        for text in svg(&figure) {
            let document = Document::parse(&text).unwrap();
            let root = document.root_element();
            assert_eq!(root.attribute("role"), Some("img"));
            let view = numbers(root.attribute("viewBox").unwrap());
            let (width, height) = (view[2], view[3]);
            let millimetres = root.attribute("width").unwrap();
            assert!(millimetres == "90mm" || millimetres == "180mm", "{millimetres}");
            let named = |name: &str| root.children().find(|node| node.has_tag_name(name)).unwrap();
            let title = named("title").text().unwrap();
            assert_eq!(title, figure.title.replace('\u{7}', " "));
            assert!(named("desc").text().unwrap().starts_with(&figure.alternative));
            let mut words = 0;
            for node in root.descendants().filter(Node::is_element) {
                if let Some(data) = node.attribute("d") {
                    assert!(!data.is_empty() && numbers(data).iter().all(|n| n.is_finite()));
                }
                if node.has_tag_name("text") {
                    words += 1;
                    inside(&node, width, height);
                }
            }
            assert!(words > 8, "{words}");
            assert!(!text.contains("NaN") && !text.contains("inf"));
        }
    }
}

/// Whether words are in the picture, as far as their width can be guessed.
#[track_caller]
fn inside(node: &Node<'_, '_>, width: f64, height: f64) {
    let words = node.text().unwrap_or_default();
    let size = number(node, "font-size");
    assert!((8.0..=9.0).contains(&size));
    let long = WIDE * size * words.chars().count() as f64;
    let before = match node.attribute("text-anchor") {
        None => 0.0,
        Some("middle") => 0.5,
        Some("end") => 1.0,
        Some(other) => panic!("{other}"),
    };
    let (x, y) = (number(node, "x"), number(node, "y"));
    let turned = node.attribute("transform").map_or(0.0, |transform| {
        numbers(transform.trim_start_matches("rotate(").trim_end_matches(')'))[0].to_radians()
    });
    for along in [-before * long, (1.0 - before) * long] {
        let (x, y) = (x + along * turned.cos(), y + along * turned.sin());
        // A guess: a tenth of the length more is still in.
        let slack = 0.1 * long + 1.0;
        assert!(x > -slack && x < width + slack, "{words:?}: {x} of {width}");
        assert!(y > -slack && y < height + slack, "{words:?}: {y} of {height}");
    }
}

#[test]
fn files_are_the_same_on_any_number_of_threads() {
    let files = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| -> Vec<Vec<u8>> {
            let sheets: Vec<_> = figures().iter().flat_map(sheets).collect();
            let format = |place: usize| if place == 0 { Format::Png } else { Format::Svg };
            let files = sheets.iter().enumerate();
            files.map(|(place, (_, sheet))| sheet.file(format(place)).unwrap()).collect()
        })
    };
    assert!(files(1) == files(2));
}

#[test]
fn png_has_300_dots_per_inch() {
    for (figure, width) in [(&everything(), 180.0), (&sets(&shipped("equilibrium-set"))[0], 90.0)] {
        let file = sheets(figure)[0].1.file(Format::Png).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(&file)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let info = reader.info();
        assert_eq!(info.width, (width / 25.4 * 300.0_f64).round() as u32);
        assert_eq!(info.pixel_dims.map(|dims| (dims.xppu, dims.yppu)), Some((11811, 11811)));
        // White paper, ink on it, and nothing on its edge.
        let (row, white) =
            (3 * info.width as usize, |bytes: &[u8]| bytes.iter().all(|b| *b == 255));
        assert!(white(&pixels[..row]) && white(&pixels[pixels.len() - row..]));
        assert!(pixels.chunks(row).all(|line| white(&line[..6]) && white(&line[row - 6..])));
        let inked = pixels.chunks(3).filter(|pixel| pixel.iter().all(|byte| *byte < 40)).count();
        assert!(inked > 5000, "{inked}");
    }
}

#[test]
fn many_dots_are_drawn_in_part_and_it_is_said() {
    let mut figure = everything();
    let many = 123_456;
    let x: Vec<f64> = (0..many).map(|k| f64::from(k) / f64::from(many)).collect();
    let layer = &mut figure.panels[2].layers[0];
    layer.mark = super::dots(stickslip::report::chart::Symbol::Dot, x.clone(), x);
    let (_, sheet) = &sheets(&figure)[0];
    let caption = sheet.caption();
    let note =
        caption.strip_prefix("A caption. Of 123470 dots ").unwrap_or_else(|| panic!("{caption}"));
    let shown: usize = note.split(' ').next().unwrap().parse().unwrap();
    assert!((19_900..=20_000).contains(&shown), "{shown}");
    let file = sheet.file(Format::Svg).unwrap();
    assert!(file.len() < 500_000, "{}", file.len());
    // In full where there are few.
    assert_eq!(sheets(&everything())[0].1.caption(), "A caption.");
}

#[test]
fn many_panels_are_on_several_sheets() {
    let mut figure = everything();
    let panel = figure.panels[0].clone();
    figure.panels = vec![panel; 30];
    let names: Vec<String> = sheets(&figure).into_iter().map(|(name, _)| name).collect();
    assert_eq!(names, ["everything-1", "everything-2", "everything-3"]);
    assert!(svg(&figure)[2].contains(">(ad) curves"));
}

/// Numbers that no axis can show are left out, and nothing breaks.
#[test]
fn odd_numbers_are_drawn() {
    let odd = [f64::NAN, f64::INFINITY, -1e300, 1e300, 0.0, -0.0, 5e-324];
    for range in [None, Some([1.0, 1.0]), Some([f64::NAN, 0.0])] {
        let mut figure = everything();
        for panel in &mut figure.panels {
            (panel.x.range, panel.y.range) = (range, range);
            for layer in &mut panel.layers {
                match &mut layer.mark {
                    Mark::Line { points, .. } | Mark::Steps { points } => {
                        points.iter_mut().zip(odd).for_each(|(point, odd)| point[1] = odd);
                    }
                    Mark::Dots { y, .. } => y.iter_mut().zip(odd).for_each(|(y, odd)| *y = odd),
                    Mark::Bars { top, .. } => top.iter_mut().zip(odd).for_each(|(y, odd)| *y = odd),
                    Mark::Band { high, .. } => high.clear(),
                    _ => {}
                }
            }
        }
        for text in svg(&figure) {
            Document::parse(&text).unwrap();
            assert!(!text.contains("NaN") && !text.contains("inf"));
        }
        sheets(&figure)[0].1.file(Format::Png).unwrap();
    }
    let empty = Figure { panels: Vec::new(), ..everything() };
    assert!(sheets(&empty).is_empty());
}
