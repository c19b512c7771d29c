//! Builders of binary hierarchies: from boxes, and triangles for those that cut them, to a [`BinaryBvh`].
//!
//! All of them build the same hierarchy on every processor and vector unit. None makes one deeper than
//! [`MOST_DEPTH`]. Boxes may be of any size, anywhere, also infinite; one that holds no point, or a NaN, is an error.
//! A builder keeps its buffers: build again with the same one.
//!
//! ```
//! use apportion::geometry::Aabb;
//! use apportion::structure::bvh::{BinaryBvh, build};
//! use glam::Vec3;
//!
//! let boxes: Vec<Aabb> = (0..1000)
//!     .map(|i| Vec3::new((i % 10) as f32, (i / 10 % 10) as f32, (i / 100) as f32))
//!     .map(|at| Aabb { min: at, max: at + 0.5 })
//!     .collect();
//! let mut builder = build::Builder::new("binned_sah", &build::Settings::default())?;
//! let mut bvh = BinaryBvh::default();
//! builder.build(&build::Input::of(&boxes), &mut bvh)?;
//! bvh.validate(&boxes)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod binned_sah;
mod bins;
mod clip;
mod curve;
mod effort;
mod few;
mod grid;
mod grow;
mod histograms;
mod lanes;
mod morton;
pub mod phased;
mod spatial_median;
mod spatial_splits;
mod sweep_sah;
#[cfg(test)]
mod tests;
mod top;
mod yard;

use super::BinaryBvh;
use crate::geometry::Aabb;
use glam::Vec3;

pub use bins::MOST_BINS;
pub use effort::Effort;

/// The most nodes on a way from the root to a leaf.
pub const MOST_DEPTH: usize = 128;
/// The most items in a cluster.
const MOST_IN_CLUSTER: usize = 32;

/// What is built over.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The items' boxes, in metres.
    pub boxes: &'a [Aabb],
    /// The triangles they are around, if they are: what spatial splits cut.
    pub triangles: Option<&'a [[Vec3; 3]]>,
}

impl<'a> Input<'a> {
    /// Items known by their boxes alone.
    pub fn of(boxes: &'a [Aabb]) -> Self {
        Self { boxes, triangles: None }
    }

    fn check(&self) -> Result<(), BuildError> {
        let items = self.boxes.len();
        if items > yard::MOST_ITEMS {
            return Err(BuildError::TooMany { items });
        }
        if let Some(triangles) = self.triangles.map(<[_]>::len).filter(|triangles| *triangles != items) {
            return Err(BuildError::Triangles { triangles, boxes: items });
        }
        Ok(())
    }
}

/// Settings of the builders; each reads those that concern it.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Bins an axis, 2 to [`MOST_BINS`].
    pub bins: usize,
    /// The most items in a leaf that the heuristic may make, from 1.
    pub most_in_leaf: usize,
    /// The most items in a leaf of cuts that weigh nothing, from 1.
    pub median_leaf: usize,
    /// The most items in a cluster of neighbours on a curve, 1 to 32.
    pub cluster: usize,
    /// What a ray pays for an inner node, in a unit of one's choice.
    pub step_cost: f32,
    /// What a ray pays for a test against an item, in the same unit.
    pub item_cost: f32,
    /// From which overlap of its sides, as a part of the root's area, a cut is held against cutting space: the alpha of
    /// Stich et al. 2009.
    pub overlap: f32,
    /// How many more references than items cutting space may make, as a part of the items.
    pub duplicates: f32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            bins: 16,
            most_in_leaf: 8,
            median_leaf: 2,
            cluster: 8,
            step_cost: 1.0,
            item_cost: 1.0,
            overlap: 1e-5,
            duplicates: 0.5,
        }
    }
}

/// Why there is no hierarchy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// An item's box is none.
    #[error("item {item}: no point is within {bounds:?}")]
    NoBox {
        /// The item.
        item: usize,
        /// Its box, in metres.
        bounds: Aabb,
    },
    /// There are too many items.
    #[error("{items} items: there can be 2147483648 at most")]
    TooMany {
        /// How many.
        items: usize,
    },
    /// There are not as many triangles as boxes.
    #[error("{triangles} triangles for {boxes} boxes")]
    Triangles {
        /// How many triangles.
        triangles: usize,
        /// How many boxes.
        boxes: usize,
    },
    /// There is no such builder.
    #[error("no builder is called `{name}`; there are {known}")]
    NoBuilder {
        /// What was asked for.
        name: String,
        /// Those there are.
        known: String,
    },
    /// A setting makes no sense.
    #[error("{setting} = {value}: it is {allowed}")]
    Setting {
        /// Which.
        setting: &'static str,
        /// What it was set to.
        value: String,
        /// What it can be.
        allowed: String,
    },
}

/// A builder in the list of builders.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct About {
    /// Its name: word of the command line, value in rows, legend.
    pub name: &'static str,
    /// What it is, in a line.
    pub summary: &'static str,
}

/// Declares the builders: the list is the table of contents. Each file holds a type of one name, with `SUMMARY`, `new`
/// and `build`; the file's name is the builder's word everywhere.
macro_rules! builders {
    ($($file:ident => $Builder:ident),* $(,)?) => {
        enum AnyBuilder { $($Builder($file::$Builder)),* }

        /// The builders, by name.
        pub const BUILDERS: &[About] =
            &[$(About { name: stringify!($file), summary: $file::SUMMARY }),*];

        impl AnyBuilder {
            fn new(name: &str, settings: &Settings) -> Result<Self, BuildError> {
                match name {
                    $(stringify!($file) => Ok(Self::$Builder($file::$Builder::new(settings))),)*
                    _ => Err(BuildError::NoBuilder {
                        name: name.to_owned(),
                        known: BUILDERS.iter().map(|builder| builder.name).collect::<Vec<_>>().join(", "),
                    })
                }
            }

            fn build(&mut self, input: &Input<'_>, bvh: &mut BinaryBvh) -> Result<(), BuildError> {
                match self { $(Self::$Builder(builder) => builder.build(input, bvh)),* }
            }
        }
    };
}

builders! {
    binned_sah => BinnedSah,
    sweep_sah => SweepSah,
    spatial_median => SpatialMedian,
    morton => Morton,
    spatial_splits => SpatialSplits,
}

/// A builder with its settings and buffers.
pub struct Builder(AnyBuilder);

impl Builder {
    /// The builder called `name`.
    ///
    /// # Errors
    /// [`BuildError::NoBuilder`], [`BuildError::Setting`].
    pub fn new(name: &str, settings: &Settings) -> Result<Self, BuildError> {
        settings.check()?;
        Ok(Self(AnyBuilder::new(name, settings)?))
    }

    /// Builds over some items, in place of what `bvh` held, whose memory is used again.
    ///
    /// # Errors
    /// [`BuildError`]; what `bvh` holds then is of no use.
    pub fn build(&mut self, input: &Input<'_>, bvh: &mut BinaryBvh) -> Result<(), BuildError> {
        input.check()?;
        self.0.build(input, bvh)
    }
}

impl Settings {
    /// Checks that all of them make sense.
    ///
    /// # Errors
    /// [`BuildError::Setting`].
    pub fn check(&self) -> Result<(), BuildError> {
        let error =
            |setting, value: String, allowed: String| Err(BuildError::Setting { setting, value, allowed });
        if !(2..=MOST_BINS).contains(&self.bins) {
            return error("bins", self.bins.to_string(), format!("2 to {MOST_BINS}"));
        }
        if !(1..=MOST_IN_CLUSTER).contains(&self.cluster) {
            return error("cluster", self.cluster.to_string(), format!("1 to {MOST_IN_CLUSTER}"));
        }
        for (setting, value) in [("most_in_leaf", self.most_in_leaf), ("median_leaf", self.median_leaf)] {
            if value == 0 {
                return error(setting, value.to_string(), "at least 1".to_owned());
            }
        }
        let numbers = [
            ("step_cost", self.step_cost),
            ("item_cost", self.item_cost),
            ("overlap", self.overlap),
            ("duplicates", self.duplicates),
        ];
        for (setting, value) in numbers {
            if !(value >= 0.0 && value.is_finite()) {
                return error(setting, value.to_string(), "a number from 0".to_owned());
            }
        }
        Ok(())
    }
}
