//! What `plotters` draws with here: lines gathered into one path a class, texts as they come.

use super::super::escape::attribute;
use super::LETTER;
use plotters::style::RGBColor;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform,
};
use std::convert::Infallible;
use std::fmt::Write;

/// Colours stand for classes: the style sheet has the last word. This one is the grid's.
pub(super) const GRID: RGBColor = RGBColor(1, 0, 0);
/// The axes'.
pub(super) const AXIS: RGBColor = RGBColor(2, 0, 0);

/// Writes to a string of its caller's when it is done.
pub(super) struct Pen<'a> {
    out: &'a mut String,
    size: (u32, u32),
    grid: String,
    axis: String,
    texts: String,
}

impl<'a> Pen<'a> {
    pub(super) fn new(out: &'a mut String, size: (u32, u32)) -> Self {
        Self { out, size, grid: String::new(), axis: String::new(), texts: String::new() }
    }
}

type Done = Result<(), DrawingErrorKind<Infallible>>;

impl DrawingBackend for Pen<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Done {
        Ok(())
    }

    fn present(&mut self) -> Done {
        for (class, path) in [("g", &mut self.grid), ("a", &mut self.axis)] {
            if !path.is_empty() {
                write!(self.out, "<path class=\"{class}\" d=\"{path}\"/>").expect("a string takes all");
                path.clear();
            }
        }
        self.out.push_str(&std::mem::take(&mut self.texts));
        Ok(())
    }

    /// Axes and grids have no lone pixels.
    fn draw_pixel(&mut self, _: BackendCoord, _: BackendColor) -> Done {
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Done {
        self.draw_path([from, to], style)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Done {
        let color = style.color();
        if color.alpha == 0.0 {
            return Ok(());
        }
        let out = if color.rgb.0 == GRID.0 { &mut self.grid } else { &mut self.axis };
        for (number, (x, y)) in path.into_iter().enumerate() {
            let letter = if number == 0 { 'M' } else { 'L' };
            write!(out, "{letter}{x} {y}").expect("a string takes all");
        }
        Ok(())
    }

    fn draw_text<T: BackendTextStyle>(&mut self, text: &str, style: &T, (x, y): BackendCoord) -> Done {
        if text.is_empty() {
            return Ok(());
        }
        let class = match style.anchor().h_pos {
            HPos::Left => "",
            HPos::Center => " class=\"m\"",
            HPos::Right => " class=\"e\"",
        };
        // From the anchor to the baseline, in the heights that common letters have.
        let down = match style.anchor().v_pos {
            VPos::Top => LETTER * 76 / 100,
            VPos::Center => LETTER * 35 / 100,
            VPos::Bottom => -LETTER / 5,
        };
        let words = attribute(text);
        let place = match style.transform() {
            FontTransform::None => format!("x=\"{x}\" y=\"{}\"", y + down),
            turned => {
                let angle = match turned {
                    FontTransform::Rotate90 => 90,
                    FontTransform::Rotate180 => 180,
                    _ => 270,
                };
                format!("transform=\"translate({x} {y})rotate({angle})\" y=\"{down}\"")
            }
        };
        write!(self.texts, "<text {place}{class}>{words}</text>").expect("a string takes all");
        Ok(())
    }
}
