//! What tells one curve from another: a colour, a mark and a dash.
//!
//! Colour and mark belong to a scheme's *name*, so that it looks the same in every chart; the settings of one scheme
//! share its colour and are told apart by mark, dash and shade. A scheme that is not named here gets a look from the
//! letters of its name; a line in [`NAMED`] gives it one of its own.

use std::f64::consts::TAU;
use std::fmt::Write;

/// Colours on white and on near black: as far apart as a search found them, to a full-colour eye and to a protan,
/// deutan and tritan one (the tests say how far). They come after the eight of Okabe and Ito (2008), three of which
/// white would swallow.
pub(crate) const COLOURS: [[&str; 2]; 9] = [
    ["#1a1a1a", "#f2f2f2"],
    ["#a9610e", "#ec7800"],
    ["#294498", "#4259d0"],
    ["#9e2737", "#c13100"],
    ["#09a38e", "#1db597"],
    ["#815f8e", "#b080f3"],
    ["#1762db", "#b6c2ff"],
    ["#c08a00", "#ffbf14"],
    ["#661351", "#86597c"],
];
/// The looks chosen by hand: name, colour, mark.
const NAMED: [(&str, usize, usize); 10] = [
    ("serial", 0, 0),
    ("global_queue", 1, 1),
    ("global_counter", 2, 2),
    ("hybrid", 3, 3),
    ("lock_free", 4, 4),
    ("receiver_initiated", 5, 5),
    ("work_stealing", 6, 6),
    ("crossbeam_deque", 7, 7),
    ("rayon_join", 8, 1),
    ("auto", 0, 6),
];
/// Corners, turn (in parts of a whole one), and how far every other corner stands out: under 1 makes a star.
const MARKS: [(u32, f64, f64); 8] = [
    (16, 0.0, 1.0),
    (4, 0.125, 1.0),
    (3, -0.25, 1.0),
    (4, 0.0, 1.0),
    (3, 0.25, 1.0),
    (8, -0.25, 0.35),
    (10, -0.25, 0.45),
    (8, -0.125, 0.35),
];
/// Drawn and left out along a line, in the units of a drawing.
const DASHES: [&str; 4] = ["", "12 6", "3 5", "14 5 3 5"];
/// How solid a line is: the second round of dashes is paler.
const SHADES: [&str; 2] = ["", ";stroke-opacity:.6"];
/// From a mark's middle to its corners, in the units of a drawing.
const RADIUS: f64 = 9.0;

/// A curve's colour, mark and dash.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Look {
    pub(crate) colour: usize,
    mark: usize,
    dash: usize,
    shade: usize,
}

impl Look {
    /// The look of a scheme, in its first setting (`variant` 0) or another.
    pub(crate) fn of(scheme: &str, variant: usize) -> Self {
        let named = NAMED.iter().find(|(name, ..)| *name == scheme);
        let (colour, mark) = named.map_or_else(
            || {
                // FNV-1a: the same look in every chart and on every computer.
                let hash = scheme.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
                    (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
                });
                (1 + (hash >> 20) as usize % (COLOURS.len() - 1), (hash >> 40) as usize % MARKS.len())
            },
            |&(_, colour, mark)| (colour, mark),
        );
        Self {
            colour,
            mark: (mark + variant) % MARKS.len(),
            // Another round of marks begins with another dash.
            dash: (variant + variant / MARKS.len()) % DASHES.len(),
            shade: variant / DASHES.len() % SHADES.len(),
        }
    }

    /// The look of the so-many-th of some things that are no schemes.
    pub(crate) fn nth(number: usize) -> Self {
        let (colour, round) = (number % COLOURS.len(), number / COLOURS.len());
        Self { colour, mark: (colour + 3 * round) % MARKS.len(), dash: 0, shade: 0 }
    }

    /// A colour with the first mark, for what is no scheme.
    pub(crate) fn plain(colour: usize) -> Self {
        Self { colour, mark: 0, dash: 0, shade: 0 }
    }

    /// The class of the curve; its marks are `m` and `h` (hollow) of the same number.
    pub(crate) fn class(self) -> String {
        format!("l{}{}{}{}", self.colour, self.mark, self.dash, self.shade)
    }

    /// The style sheet of the look, its colours given by their number.
    pub(crate) fn css(self, colour: impl Fn(usize) -> String) -> String {
        let Self { colour: number, mark, dash, shade } = self;
        let colour = colour(number);
        let dashes = DASHES[dash];
        let dashes = if dashes.is_empty() { String::new() } else { format!(";stroke-dasharray:{dashes}") };
        let url = |kind: char| {
            let id = format!("url(#{kind}{number}{mark})");
            format!("marker-start:{id};marker-mid:{id};marker-end:{id}")
        };
        let (class, shade) = (self.class(), SHADES[shade]);
        format!(".{class}{{stroke:{colour}{dashes}{shade};{}}}.{class}.h{{{}}}\n", url('m'), url('h'))
    }

    /// The definitions of its marks: ours are filled, the paper's hollow.
    pub(crate) fn marks(self, colour: impl Fn(usize) -> String, background: &str) -> String {
        let (shape, ink) = (self.outline(), colour(self.colour));
        let one = |kind: char, inside: &str| {
            format!(
                "<marker id=\"{kind}{}{}\" viewBox=\"-12 -12 24 24\" markerWidth=\"24\" markerHeight=\"24\" \
                 markerUnits=\"userSpaceOnUse\"><path d=\"{shape}\" style=\"fill:{inside};stroke:{ink};\
                 stroke-width:3;stroke-linejoin:round\"/></marker>",
                self.colour, self.mark
            )
        };
        one('m', &ink) + &one('h', background) + "\n"
    }

    /// Looks that share colour and mark share their definitions.
    pub(crate) fn mark_id(self) -> (usize, usize) {
        (self.colour, self.mark)
    }

    /// The mark's word in a Vega-Lite specification: the nearest it has.
    pub(crate) fn vega_shape(self) -> &'static str {
        ["circle", "square", "triangle-up", "diamond", "triangle-down", "cross", "wedge", "stroke"][self.mark]
    }

    /// The mark as a path about the origin.
    pub(crate) fn outline(self) -> String {
        let (corners, turn, waist) = MARKS[self.mark];
        let mut path = String::from("M");
        for number in 0..corners {
            let angle = TAU * (f64::from(number) / f64::from(corners) + turn);
            let radius = if number % 2 == 0 { RADIUS } else { RADIUS * waist };
            let space = if number == 0 { "" } else { " " };
            // Adding zero makes -0.0 a plain 0.
            let [x, y] =
                [radius * angle.cos(), radius * angle.sin()].map(|at| (at * 10.0).round() / 10.0 + 0.0);
            write!(path, "{space}{x},{y}").expect("a string takes all");
        }
        path + "Z"
    }
}

#[cfg(test)]
#[path = "marker_tests.rs"]
mod tests;
