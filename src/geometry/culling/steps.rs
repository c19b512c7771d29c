//! Which steps a test is made of.

use std::str::FromStr;

/// The space a volume is tested in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// Plane by plane in world space: n-vertex and p-vertex (Paper I sec. 3.1).
    #[default]
    World,
    /// The eight corners transformed to perspective space and bounded there by a box: the baseline of
    /// Paper I (sec. 2, DirectModel).
    Perspective,
    /// The eight corners transformed to clip space, where a plane is one comparison a corner (Bubeníček
    /// sec. 2).
    Clip,
}

/// The plane a volume keeps, to be tested first next time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cached {
    /// None.
    #[default]
    Nothing,
    /// The plane that rejected it (plane-coherency, Paper I sec. 3.2).
    Rejecting,
    /// The plane that rejected it, or else the first it crosses (Paper I sec. 5, future work).
    Crossed,
}

/// The octant test of symmetric frusta (Paper I sec. 3.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Octant {
    /// Off.
    #[default]
    Off,
    /// On; when the three planes say inside, the other three are asked too, because near the narrow end
    /// an elongated box may cross a plane that was not chosen (finding P1-F04).
    Checked,
    /// On, as the paper has it: a box that passes the condition on its size and is inside three planes is
    /// called inside. It may cross another: nothing is culled wrongly, but what relies on "inside"
    /// (masking, clipping turned off) may err.
    AsPublished,
}

/// The steps of a test, in the order they are taken (Paper I sec. 3): rotation coherency, translation
/// coherency, cached plane, octant or all planes but the masked.
///
/// Read from words joined by `+`, such as `plane+octant+fields`, see [`STEPS`]; `basic` stands for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Steps {
    /// The space the volume is tested in; outside world space there are no other steps.
    pub space: Space,
    /// Rotation coherency: what was outside the plane that trails when the camera only turns stays outside
    /// (Paper I sec. 3.5).
    pub rotation: bool,
    /// Translation coherency: when the camera only moves, all distances to a plane change by the same
    /// amount (Paper I sec. 3.5).
    pub translation: bool,
    /// The plane tested first.
    pub cached: Cached,
    /// The octant test.
    pub octant: Octant,
    /// Masking: planes that the parent is inside of are skipped (Paper I sec. 3.4).
    pub masking: bool,
    /// Near and far as one pair of parallel planes (Paper I sec. 5, future work).
    pub pair: bool,
    /// Sign fields once a frame instead of once a test (Paper I sec. 4: 5 to 10 % faster, boxes only; a
    /// k-DOP has directions and weights there).
    pub fields: bool,
}

/// A step that can be asked for by a word.
pub struct Step {
    /// The word.
    pub word: &'static str,
    /// What it is, in a few words.
    pub about: &'static str,
    add: fn(&mut Steps),
}

/// All steps, by word.
pub const STEPS: &[Step] = &[
    Step { word: "basic", about: "all six planes, nothing else", add: |_| {} },
    Step {
        word: "perspective",
        about: "corners to perspective space, Paper I's baseline; alone",
        add: |s| s.space = Space::Perspective,
    },
    Step { word: "clip", about: "corners to clip space; alone", add: |s| s.space = Space::Clip },
    Step { word: "plane", about: "the plane that rejected it first", add: |s| s.cached = Cached::Rejecting },
    Step { word: "crossed", about: "as plane, or one it crossed", add: |s| s.cached = Cached::Crossed },
    Step { word: "octant", about: "three planes of its octant", add: |s| s.octant = Octant::Checked },
    Step {
        word: "octant_as_published",
        about: "the same, with inside unchecked",
        add: |s| s.octant = Octant::AsPublished,
    },
    Step { word: "mask", about: "no planes the parent is inside of", add: |s| s.masking = true },
    Step { word: "rotation", about: "rotation coherency", add: |s| s.rotation = true },
    Step { word: "translation", about: "translation coherency", add: |s| s.translation = true },
    Step { word: "tr", about: "both of them", add: |s| (s.rotation, s.translation) = (true, true) },
    Step { word: "pair", about: "near and far at once", add: |s| s.pair = true },
    Step { word: "fields", about: "sign fields once a frame", add: |s| s.fields = true },
];

/// Why some words are no test.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StepsError {
    /// There is no such step.
    #[error("there is no step `{word}`; expected words joined by `+`: {known}")]
    Unknown {
        /// The word.
        word: String,
        /// The words there are.
        known: String,
    },
    /// Two steps that do not go together.
    #[error("`{space}` is a test of its own; expected no other step beside it")]
    Alone {
        /// The word of the test.
        space: &'static str,
    },
    /// A word twice, or two that set the same.
    #[error("`{word}` says anew what a word before it said; expected each step once")]
    Twice {
        /// The word.
        word: String,
    },
}

impl Steps {
    /// No step beyond the six planes.
    pub const BASIC: Self = Self {
        space: Space::World,
        rotation: false,
        translation: false,
        cached: Cached::Nothing,
        octant: Octant::Off,
        masking: false,
        pair: false,
        fields: true,
    };

    /// Plane-coherency and the octant test: the paper's advice for symmetric frusta (sec. 4), and what
    /// Paper II shares out.
    pub const ADVISED: Self = Self { cached: Cached::Rejecting, octant: Octant::Checked, ..Self::BASIC };

    /// Whether a volume has to keep something from frame to frame.
    pub fn remember(&self) -> bool {
        self.rotation || self.translation || self.cached != Cached::Nothing
    }
}

impl Steps {
    /// Which parts differ from the basic test's, the space last.
    fn parts(&self) -> [bool; 8] {
        [
            self.rotation,
            self.translation,
            self.cached != Cached::Nothing,
            self.octant != Octant::Off,
            self.masking,
            self.pair,
            self.fields,
            self.space != Space::World,
        ]
    }
}

impl FromStr for Steps {
    type Err = StepsError;

    fn from_str(text: &str) -> Result<Self, StepsError> {
        let bare = Steps { fields: false, ..Steps::BASIC };
        let mut steps = bare;
        for word in text.split('+').map(str::trim) {
            let Some(step) = STEPS.iter().find(|step| step.word == word) else {
                let known = STEPS.iter().map(|step| step.word).collect::<Vec<_>>().join(", ");
                return Err(StepsError::Unknown { word: word.to_owned(), known });
            };
            let mut alone = bare;
            (step.add)(&mut alone);
            if alone.parts().iter().zip(steps.parts()).any(|(new, old)| *new && old) {
                return Err(StepsError::Twice { word: word.to_owned() });
            }
            (step.add)(&mut steps);
        }
        let [others @ .., _] = steps.parts();
        match steps.space {
            Space::Perspective if others.contains(&true) => Err(StepsError::Alone { space: "perspective" }),
            Space::Clip if others.contains(&true) => Err(StepsError::Alone { space: "clip" }),
            _ => Ok(steps),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_make_steps() {
        assert_eq!("plane+octant+fields".parse(), Ok(Steps::ADVISED));
        assert_eq!("basic".parse(), Ok(Steps { fields: false, ..Steps::BASIC }));
        let all: Steps = "tr + crossed + octant_as_published + mask + pair".parse().unwrap();
        assert!(all.rotation && all.translation && all.masking && all.pair && !all.fields);
        assert_eq!(all.cached, Cached::Crossed);
        for step in STEPS {
            assert!(step.word.parse::<Steps>().is_ok(), "{}", step.word);
        }
    }

    #[test]
    fn what_is_no_test_is_refused() {
        for (text, part) in [
            ("planes", "no step `planes`"),
            ("", "no step ``"),
            ("plane+", "no step ``"),
            ("perspective+plane", "a test of its own"),
            ("fields+clip", "a test of its own"),
            ("plane+plane", "each step once"),
            ("plane+crossed", "each step once"),
            ("tr+rotation", "each step once"),
        ] {
            let error = text.parse::<Steps>().expect_err(text).to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
