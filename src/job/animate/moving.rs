//! A scene that moves, and the hierarchy that is kept up over it.

use crate::job::trace::{Hierarchy, Levels, TriangleKind, World, default_view};
use crate::scene::{Pose, Scene, View};
use crate::scheme::frames::{Foretold, Kept};
use crate::structure::bvh::build::{BuildError, Builder};

/// A scene at one time after the other, for rays.
///
/// Of two levels ([`Levels`]), meshes that keep their shape are built once, however they move; a rebuild or refit is of
/// those that change shape, and the hierarchy over places is made anew either way. Of one level, it is of everything.
pub struct Moving {
    world: World,
    pose: Pose,
    builder: Builder,
    levels: Levels,
    triangle: TriangleKind,
    /// None before it is first made.
    hierarchy: Option<Hierarchy>,
    /// Meshes that change shape, by number.
    bent: Vec<u32>,
    /// What was seen when the hierarchy was last made.
    seen: Vec<bool>,
}

impl Moving {
    /// A valid scene, and how hierarchies over it are to be built.
    pub fn new(scene: Scene, builder: Builder, levels: Levels, triangle: TriangleKind) -> Self {
        let bent = scene.animation.bends.iter().map(|bend| bend.mesh).collect();
        let (world, pose) = (World::new(scene), Pose::default());
        Self { world, pose, builder, levels, triangle, hierarchy: None, bent, seen: Vec::new() }
    }

    /// Goes to a time, in seconds. The hierarchy is still that of the time before.
    pub fn advance(&mut self, time: f64) {
        self.world.scene().pose_into(time, &mut self.pose);
        self.world.follow(&self.pose);
    }

    /// The scene as it is now.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// The scene as it is now; to add lights to.
    pub fn world_mut(&mut self) -> &mut World {
        &mut self.world
    }

    /// What answers for its rays.
    ///
    /// # Panics
    /// If it was never rebuilt.
    pub fn hierarchy(&self) -> &Hierarchy {
        self.hierarchy.as_ref().expect("a frame scheme makes it first")
    }

    /// Where it is looked at from now: from where its camera is, or else so that all of it is seen as it stands when
    /// nothing moves.
    pub fn view(&self, aspect: f32) -> Option<View> {
        self.pose.view.or_else(|| {
            let camera = default_view(self.world.scene(), aspect)?;
            let [_, _, below, above] = camera.lens.tangents();
            let (look, up) = (camera.eye + camera.forward, camera.up);
            let fov_y = (above.atan() - below.atan()) as f32;
            Some(View { eye: camera.eye, look, up, fov_y })
        })
    }
}

impl Kept for Moving {
    type Error = BuildError;

    fn rebuild(&mut self) -> Result<(), BuildError> {
        // Nothing is left of one that failed.
        let kept = self.hierarchy.take();
        self.hierarchy = Some(match kept {
            Some(mut hierarchy) => {
                hierarchy.update(&self.world, &self.bent, &mut self.builder)?;
                hierarchy
            }
            None => Hierarchy::of(&self.world, self.levels, &mut self.builder, self.triangle)?,
        });
        self.seen.clone_from(&self.pose.visible);
        Ok(())
    }

    fn refit(&mut self) -> Result<(), BuildError> {
        // Of one level, triangles that come or go are not taken in by a refit.
        let Some(mut hierarchy) =
            self.hierarchy.take_if(|_| self.levels == Levels::Two || self.seen == self.pose.visible)
        else {
            return self.rebuild();
        };
        hierarchy.refit(&self.world, &self.bent, &mut self.builder)?;
        self.hierarchy = Some(hierarchy);
        Ok(())
    }

    fn cost(&self) -> f64 {
        self.hierarchy().expected_cost()
    }
}

/// A scene that moves, at times that are all known beforehand, in seconds.
pub(super) struct Ahead<'a> {
    pub(super) moving: &'a mut Moving,
    pub(super) times: &'a [f64],
}

impl Foretold for Ahead<'_> {
    type Error = BuildError;

    fn count(&self) -> usize {
        self.times.len()
    }

    fn costs(&mut self, made: usize, end: usize) -> Result<Vec<f64>, BuildError> {
        let cost = |(number, time): (usize, &f64)| {
            self.moving.advance(*time);
            if number == 0 {
                self.moving.rebuild()?
            } else {
                self.moving.refit()?
            }
            Ok(self.moving.cost())
        };
        self.times[made..end].iter().enumerate().map(cost).collect()
    }
}
