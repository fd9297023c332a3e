//! A scene as PNG, 300 dots per inch.

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Mask, Paint as Brush, PathBuilder, Pixmap,
    PremultipliedColorU8, StrokeDash, Transform,
};

use super::PaperError;
use super::font::{self, Pen};
use super::scene::{Anchor, Box2, Item, Paint, Scene, Step, Stroke};
use crate::report::chart::Figure;
use crate::table::VERSION;

/// Dots per inch.
pub const RESOLUTION: f64 = 300.0;

/// The picture.
///
/// # Errors
/// Where it would be too large, or cannot be written.
pub fn png(scene: &Scene, figure: &Figure) -> Result<Vec<u8>, PaperError> {
    let scale = RESOLUTION / 72.0;
    let [width, height] = scene.size.map(|points| (points * scale).round() as u32);
    let failed = |cause: &str| PaperError(cause.to_owned());
    let mut pixels = Pixmap::new(width, height).ok_or_else(|| failed("no room for its pixels"))?;
    pixels.fill(Color::WHITE);
    let scaled = Transform::from_scale(scale as f32, scale as f32);
    let mut mask: Option<(Box2, Mask)> = None;
    for item in &scene.items {
        match item {
            Item::Path { steps, fill, stroke, clip } => {
                let Some(path) = path(steps) else { continue };
                if let Some(area) = clip
                    && mask.as_ref().is_none_or(|(kept, _)| kept != area)
                {
                    let mut made =
                        Mask::new(width, height).ok_or_else(|| failed("no room for its pixels"))?;
                    if let Some(area) = self::path(&area.steps()) {
                        made.fill_path(&area, FillRule::Winding, true, scaled);
                    }
                    mask = Some((*area, made));
                }
                let seen = mask.as_ref().filter(|_| clip.is_some()).map(|(_, mask)| mask);
                if let Some(paint) = fill {
                    pixels.fill_path(&path, &brush(*paint), FillRule::Winding, scaled, seen);
                }
                if let Some(Stroke { paint, width, dash }) = stroke {
                    let dashes = dash.iter().map(|length| *length as f32).collect();
                    let line = tiny_skia::Stroke {
                        width: *width as f32,
                        line_cap: if dash.is_empty() { LineCap::Round } else { LineCap::Butt },
                        line_join: LineJoin::Round,
                        dash: StrokeDash::new(dashes, 0.0),
                        ..tiny_skia::Stroke::default()
                    };
                    pixels.stroke_path(&path, &brush(*paint), &line, scaled, seen);
                }
            }
            Item::Text { at, size, anchor, turned, words } => {
                let mut outline = Outline(PathBuilder::new());
                font::outline(words, &mut outline);
                let Some(path) = outline.0.finish() else { continue };
                let before = match anchor {
                    Anchor::Start => 0.0,
                    Anchor::Middle => 0.5,
                    Anchor::End => 1.0,
                } * font::width(words, 1.0);
                let place = Transform::from_translate(-before as f32, 0.0)
                    .post_scale(*size as f32, -*size as f32)
                    .post_concat(Transform::from_rotate(*turned as f32))
                    .post_translate(at[0] as f32, at[1] as f32)
                    .post_concat(scaled);
                let black = brush(Paint::of(super::colours::INK));
                pixels.fill_path(&path, &black, FillRule::Winding, place, None);
            }
        }
    }
    encoded(&pixels, figure).map_err(|error| failed(&error.to_string()))
}

fn encoded(pixels: &Pixmap, figure: &Figure) -> Result<Vec<u8>, png::EncodingError> {
    let opaque = |pixel: &PremultipliedColorU8| [pixel.red(), pixel.green(), pixel.blue()];
    let bytes: Vec<u8> = pixels.pixels().iter().flat_map(opaque).collect();
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, pixels.width(), pixels.height());
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let per_metre = (RESOLUTION / 0.0254).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions {
        xppu: per_metre,
        yppu: per_metre,
        unit: png::Unit::Meter,
    }));
    encoder.add_text_chunk("Software".to_owned(), format!("stickslip {VERSION}"))?;
    encoder.add_itxt_chunk("Title".to_owned(), figure.title.clone())?;
    let words = format!("{}\n{}", figure.alternative, figure.caption);
    encoder.add_itxt_chunk("Description".to_owned(), words)?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    Ok(file)
}

fn brush(paint: Paint) -> Brush<'static> {
    let mut brush = Brush::default();
    let [red, green, blue] = paint.rgb;
    brush.set_color_rgba8(red, green, blue, (255.0 * paint.opacity).round() as u8);
    brush
}

fn path(steps: &[Step]) -> Option<tiny_skia::Path> {
    let mut path = PathBuilder::new();
    for step in steps {
        let single = |[x, y]: [f64; 2]| (x as f32, y as f32);
        match *step {
            Step::Move(to) => {
                let (x, y) = single(to);
                path.move_to(x, y);
            }
            Step::Line(to) => {
                let (x, y) = single(to);
                path.line_to(x, y);
            }
            Step::Close => path.close(),
            Step::Circle(at, radius) => {
                let (x, y) = single(at);
                path.push_circle(x, y, radius as f32);
            }
            Step::Point(at) => {
                let (x, y) = single(at);
                path.move_to(x, y);
                path.line_to(x + 0.01, y);
            }
        }
    }
    path.finish()
}

struct Outline(PathBuilder);

impl Pen for Outline {
    fn move_to(&mut self, [x, y]: [f64; 2]) {
        self.0.move_to(x as f32, y as f32);
    }

    fn line_to(&mut self, [x, y]: [f64; 2]) {
        self.0.line_to(x as f32, y as f32);
    }

    fn curve_to(&mut self, by: [f64; 2], [x, y]: [f64; 2]) {
        self.0.quad_to(by[0] as f32, by[1] as f32, x as f32, y as f32);
    }

    fn close(&mut self) {
        self.0.close();
    }
}
