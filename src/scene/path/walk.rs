//! A person walking through a hall.

use std::f64::consts::{PI, TAU};

use glam::{DVec2, Vec3};

use super::super::{Aisles, GENERATORS, SplitMix64};
use super::{CameraPath, LENS, PathKind};
use crate::geometry::Camera;

/// [`CameraPath::walk`] in a generated scene; only those have aisles.
pub(super) const WALK: PathKind = PathKind {
    name: "walk",
    about: "a person walking along the aisles of a generated scene (Paper I sec. 4, path 1)",
    make: |scene, frames, seed| {
        let generator = GENERATORS.iter().find(|generator| generator.name == scene.name);
        generator.map_or_else(CameraPath::default, |g| CameraPath::walk(&g.aisles(), frames, seed))
    },
};

/// Seconds from frame to frame.
const STEP: f64 = 0.1;
/// Metres a second.
const SPEED: f64 = 1.4;
/// Metres from the floor.
const EYE_HEIGHT: f32 = 1.7;
/// Distance of the near plane, in metres.
const NEAR: f32 = 0.1;
/// Share of the way to the wanted speed, or gaze, that is made good each step.
const EASE: f64 = 0.2;
/// How near a crossing counts as reached, in metres; corners are cut by about as much.
const REACHED: f64 = 0.6;

/// A person at a crossing or on the way to one.
struct Walker<'a> {
    aisles: &'a Aisles,
    random: SplitMix64,
    /// Which aisles cross at the goal.
    goal: [usize; 2],
    along_x: bool,
    place: DVec2,
    velocity: DVec2,
    /// Direction of the body and of the head against it, in radians about y; of the gaze, upward.
    heading: f64,
    head: f64,
    pitch: f64,
    wanted_head: f64,
    wanted_pitch: f64,
    /// Steps still to stand.
    standing: usize,
}

impl CameraPath {
    /// A user's walk along the aisles of a hall, in the manner of the recorded walks of Paper I sec. 4
    /// (path 1) and Paper II sec. 2, of which only this much is known. Eyes at 1.7 m, 1.4 m/s, ten
    /// frames a second; the head turns while walking, and at some crossings the walker stands and looks
    /// around. 60 degrees up and down, 4:3, from 0.1 m to [`Aisles::far`]. No frames for a hall without
    /// aisles.
    pub fn walk(aisles: &Aisles, frames: usize, seed: u64) -> Self {
        if aisles.is_empty() {
            return Self::default();
        }
        let mut walker = Walker::new(aisles, seed);
        let frames = (0..frames).filter_map(|_| {
            walker.step();
            walker.camera()
        });
        Self { frames: frames.collect() }
    }
}

impl<'a> Walker<'a> {
    fn new(aisles: &'a Aisles, seed: u64) -> Self {
        let mut random = SplitMix64::new(seed);
        let goal = [random.below(aisles.x.len()), random.below(aisles.z.len())];
        let heading = random.between(-PI, PI);
        let place = at(aisles, goal);
        Self {
            aisles,
            random,
            goal,
            along_x: false,
            place,
            velocity: DVec2::ZERO,
            heading,
            head: 0.0,
            pitch: 0.0,
            wanted_head: 0.0,
            wanted_pitch: 0.0,
            standing: 10,
        }
    }

    fn step(&mut self) {
        let mut to_goal = at(self.aisles, self.goal) - self.place;
        if to_goal.length() < REACHED {
            self.choose_goal();
            to_goal = at(self.aisles, self.goal) - self.place;
        }
        let wanted = if self.standing > 0 { DVec2::ZERO } else { to_goal.normalize_or_zero() * SPEED };
        self.standing = self.standing.saturating_sub(1);
        self.velocity += (wanted - self.velocity) * EASE;
        self.place += self.velocity * STEP;
        // The body turns to where the walk goes, before the first stride as well.
        if to_goal != DVec2::ZERO {
            let turn = to_goal.y.atan2(to_goal.x) - self.heading;
            let turn = (turn + PI).rem_euclid(TAU) - PI;
            self.heading += (turn * EASE).clamp(-0.15, 0.15);
        }
        // About every three seconds something else draws the eye.
        if self.random.below(30) == 0 {
            let reach = if self.standing > 0 { 1.6 } else { 0.7 };
            self.wanted_head = self.random.between(-reach, reach);
            self.wanted_pitch = self.random.between(-0.35, 0.2);
        }
        self.head += (self.wanted_head - self.head) * EASE;
        self.pitch += (self.wanted_pitch - self.pitch) * EASE;
    }

    /// Turns at each crossing, from an aisle along x into one along z and back, as far as there is a
    /// choice; at two crossings in five the walker stands for two to five seconds.
    fn choose_goal(&mut self) {
        self.along_x = !self.along_x;
        let (axis, count) = if self.along_x { (0, self.aisles.x.len()) } else { (1, self.aisles.z.len()) };
        if count > 1 {
            self.goal[axis] = (self.goal[axis] + 1 + self.random.below(count - 1)) % count;
        }
        if self.random.below(5) < 2 {
            self.standing = 20 + self.random.below(30);
        }
    }

    fn camera(&self) -> Option<Camera> {
        let eye = Vec3::new(self.place.x as f32, EYE_HEIGHT, self.place.y as f32);
        let (sin, cos) = (self.heading + self.head).sin_cos();
        let (rise, flat) = self.pitch.sin_cos();
        let gaze = Vec3::new((cos * flat) as f32, rise as f32, (sin * flat) as f32);
        Camera::look_at(eye, eye + gaze * 8.0, Vec3::Y, LENS, NEAR, self.aisles.far).ok()
    }
}

fn at(aisles: &Aisles, goal: [usize; 2]) -> DVec2 {
    DVec2::new(aisles.x[goal[0]].into(), aisles.z[goal[1]].into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::GENERATORS;

    #[test]
    fn walks_are_smooth_inside_and_the_same_each_time() {
        let halls = GENERATORS.iter().filter(|generator| !generator.aisles().is_empty());
        assert!(halls.clone().count() >= 12);
        for generator in halls {
            let aisles = generator.aisles();
            let path = CameraPath::walk(&aisles, 2000, 3);
            assert_eq!(path.frames.len(), 2000);
            assert_eq!(path, CameraPath::walk(&aisles, 2000, 3));
            assert_ne!(path, CameraPath::walk(&aisles, 2000, 4));
            let bounds = generator.generate().bounds();
            let (mut still, mut turning) = (0, 0);
            for pair in path.frames.windows(2) {
                let step = pair[1].eye - pair[0].eye;
                let turn = pair[0].forward.angle_between(pair[1].forward);
                assert!(step.length() < 0.15 && turn < 0.6, "step {step}, turn {turn}");
                assert!(
                    pair[1].eye.cmpgt(bounds.min + 1.0).all() && pair[1].eye.cmplt(bounds.max - 1.0).all()
                );
                still += u32::from(step.length() < 0.005);
                turning += u32::from(turn > 0.005 && step.length() > 0.05);
            }
            assert!(still > 50 && turning > 300, "{}: {still} still, {turning} turning", generator.name);
        }
    }
}
