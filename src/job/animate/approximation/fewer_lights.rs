//! Fewer shadow rays: a point asks some of the lights, which stand for all (Shirley, Wang and Zimmerman 1996, of many
//! lights).

use super::{About, Knob, Method};
use crate::job::trace::Look;

pub(super) const ABOUT: About = About {
    name: "fewer_lights",
    summary: "each point asks some of the lights, which stand for all",
    knob: Knob { about: "lights a point asks at most", default: 1.0, least: 1.0, most: 1e6 },
    make: |lights| Box::new(FewerLights { lights: lights as u32 }),
};

struct FewerLights {
    lights: u32,
}

impl Method for FewerLights {
    fn look(&self, look: Look) -> Look {
        Look { most_lights: look.most_lights.min(self.lights), ..look }
    }
}
