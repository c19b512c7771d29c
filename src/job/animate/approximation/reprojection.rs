//! What was seen in the frame before is put where it is seen from now; what nothing comes to lie on is traced (P3-A02;
//! Badt 1988). What moved by itself stays behind, highlights and reflections too, until its pixels have their turn.
//!
//! A point is put into the pixel it falls in, and seen through that pixel's middle from then on, so it creeps by up to
//! half a pixel a frame, until it has its turn.

use super::turns::{PARTS, has_turn};
use super::{About, Knob, Method, Seen};
use crate::job::trace::{Draft, Eye};

pub(super) const ABOUT: About = About {
    name: "reprojection",
    summary: "what the frame before saw is put where it is seen from now",
    knob: Knob {
        about: "sixteenths of the pixels that are traced all the same",
        default: 4.0,
        least: 1.0,
        most: 16.0,
    },
    make: |traced| Box::new(Reprojection { traced: traced as u32 }),
};

struct Reprojection {
    traced: u32,
}

/// A point at infinity is put so many metres away, times the size of the eye's coordinates.
const FAR: f64 = 1e6;

impl Method for Reprojection {
    fn looks_back(&self) -> bool {
        true
    }

    fn draft(&self, eye: &Eye, number: u32, before: &Seen) -> Option<Draft> {
        let (width, height) = eye.size();
        let mut draft = Draft::new((width, height));
        let origin = eye.ray(0, 0).origin.as_dvec3();
        let infinity = FAR * origin.abs().max_element().max(1.0);
        let projection = eye.projection();
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            let [r, g, b, distance] = before.pixel(x, y);
            let ray = before.eye.ray(x, y);
            let far = if distance.is_finite() { f64::from(distance) } else { infinity };
            let point = ray.origin.as_dvec3() + ray.direction.as_dvec3() * far;
            let Some((across, down)) = projection.place_of(point) else { continue };
            if !(across >= 0.0 && down >= 0.0 && across < f64::from(width) && down < f64::from(height)) {
                continue;
            }
            let place = (across as u32, down as u32);
            if has_turn(place, number, self.traced.min(PARTS)) {
                continue;
            }
            let distance = if distance.is_finite() { point.distance(origin) as f32 } else { f32::INFINITY };
            // Of what falls into one pixel the nearest is seen.
            if draft.known(place.0, place.1).is_none_or(|known| distance < known[3]) {
                draft.set(place.0, place.1, [r, g, b, distance]);
            }
        }
        Some(draft)
    }
}
