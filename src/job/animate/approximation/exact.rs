//! None: every pixel of every frame.

use super::{About, Knob, Method};

pub(super) const ABOUT: About = About {
    name: "exact",
    summary: "every pixel of every frame is traced",
    knob: Knob { about: "none", default: 0.0, least: 0.0, most: 0.0 },
    make: |_| Box::new(Exact),
};

struct Exact;

impl Method for Exact {}
