//! What tells one curve from another: a colour and a shape.

use plotters::element::{ComposedElement, EmptyElement, PathElement, Polygon};
use plotters::prelude::DrawingBackend;
use plotters::style::{Color, RGBColor, WHITE};

use std::f64::consts::TAU;

/// The palette of Okabe and Ito (2008), told apart by colour-blind readers; without its yellow, which white swallows.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 0, 0),
    RGBColor(230, 159, 0),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
];
/// Corners and turn (in parts of a whole one) of each shape; one more than there are colours, so that pairs come
/// round again only after 56 curves.
const SHAPES: [Shape; 8] = [
    Shape { corners: 20, turn: 0.0, waist: 1.0 },
    Shape { corners: 4, turn: 0.125, waist: 1.0 },
    Shape { corners: 3, turn: -0.25, waist: 1.0 },
    Shape { corners: 4, turn: 0.0, waist: 1.0 },
    Shape { corners: 3, turn: 0.25, waist: 1.0 },
    Shape { corners: 8, turn: -0.25, waist: 0.35 },
    Shape { corners: 10, turn: -0.25, waist: 0.45 },
    Shape { corners: 8, turn: -0.125, waist: 0.35 },
];
/// From a marker's middle to its corners, pixels.
const RADIUS: f64 = 7.0;

#[derive(Clone, Copy)]
struct Shape {
    corners: u32,
    turn: f64,
    /// How far every other corner stands out, as a share of the radius: under 1 makes a star.
    waist: f64,
}

/// A marker as the drawing library holds it: its inside, then its outline.
type Marker<C, B> = ComposedElement<C, B, Polygon<(i32, i32)>, PathElement<(i32, i32)>>;

/// A curve's colour and marker.
#[derive(Clone, Copy)]
pub(crate) struct Look {
    pub(crate) colour: RGBColor,
    shape: Shape,
}

impl Look {
    /// The look of the curve of that number.
    pub(crate) fn of(number: usize) -> Self {
        Self { colour: COLOURS[number % COLOURS.len()], shape: SHAPES[number % SHAPES.len()] }
    }

    /// A marker: ours are filled, the paper's hollow.
    pub(crate) fn marker<C, B: DrawingBackend>(self, at: C, hollow: bool) -> Marker<C, B> {
        let corner = |number: u32| {
            let angle = TAU * (f64::from(number) / f64::from(self.shape.corners) + self.shape.turn);
            let radius = if number.is_multiple_of(2) { RADIUS } else { RADIUS * self.shape.waist };
            ((radius * angle.cos()).round() as i32, (radius * angle.sin()).round() as i32)
        };
        let outline: Vec<(i32, i32)> = (0..=self.shape.corners).map(corner).collect();
        let inside = if hollow { WHITE.filled() } else { self.colour.filled() };
        EmptyElement::at(at)
            + Polygon::new(outline.clone(), inside)
            + PathElement::new(outline, self.colour.stroke_width(2))
    }
}
