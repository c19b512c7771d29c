//! Fewer bounces (P3-A03).

use super::{About, Knob, Method};
use crate::job::trace::{Look, MOST_DEPTH};

pub(super) const ABOUT: About = About {
    name: "lower_depth",
    summary: "fewer reflections and refractions follow on one another",
    knob: Knob { about: "bounces followed at most", default: 1.0, least: 0.0, most: MOST_DEPTH as f64 },
    make: |depth| Box::new(LowerDepth { depth: depth as u32 }),
};

struct LowerDepth {
    depth: u32,
}

impl Method for LowerDepth {
    fn look(&self, look: Look) -> Look {
        Look { depth: look.depth.min(self.depth), ..look }
    }
}
