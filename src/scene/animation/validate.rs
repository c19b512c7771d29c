//! What must hold of what moves in a scene.

use glam::{Quat, Vec3};

use super::super::{Scene, SceneError};
use super::{Curve, Motion};

/// The least keys a Kochanek-Bartels spline can have.
const SPLINE: usize = 4;
/// The furthest time from 0, in seconds: twice the age of the world. Slopes times this stay finite.
pub(in crate::scene) const FURTHEST: f64 = 1e18;

impl Scene {
    /// Checks that what moves is there, once; that keys are in order, enough and finite; that a bent mesh keeps its
    /// counts.
    ///
    /// # Errors
    /// [`SceneError::Malformed`] naming the first motion or bend that is not right.
    pub(in crate::scene) fn check_animation(&self, file: &str) -> Result<(), SceneError> {
        let fail = |place: String, found: String, expected: &str| {
            Err(SceneError::malformed(file, place, found, expected))
        };
        let animation = &self.animation;
        let (start, end) = (animation.start, animation.end);
        if !(start <= end && start.abs().max(end.abs()) <= FURTHEST) {
            return fail(
                "animation".into(),
                format!("from {start} to {end} s"),
                "a start, then an end, within 1e18 s",
            );
        }
        for (index, motion) in animation.motions.iter().enumerate() {
            if let Err((found, expected)) = motion.check() {
                return fail(format!("motion {index} {:?}", motion.name), found, expected);
            }
        }
        let motions = animation.motions.len();
        let lists = [
            ("node", self.nodes.len(), &animation.followers),
            ("light", self.lights.len(), &animation.lights),
        ];
        for (what, count, list) in lists {
            let mut follows = vec![false; count];
            for (item, motion) in list {
                let place = format!("animation of {what} {item}");
                if *motion as usize >= motions {
                    return fail(place, format!("motion {motion}"), &format!("a motion below {motions}"));
                }
                match follows.get_mut(*item as usize) {
                    Some(follows) if !*follows => *follows = true,
                    Some(_) => return fail(place, "a second motion".into(), "one motion at most"),
                    None => return fail(place, format!("{what} {item}"), &format!("one below {count}")),
                }
            }
        }
        if let Some(camera) = animation.camera.filter(|camera| *camera as usize >= motions) {
            return fail("camera".into(), format!("motion {camera}"), &format!("a motion below {motions}"));
        }
        self.check_bends(file)
    }

    fn check_bends(&self, file: &str) -> Result<(), SceneError> {
        let mut bends = vec![false; self.meshes.len()];
        for (index, bend) in self.animation.bends.iter().enumerate() {
            let fail = |found: String, expected: &str| {
                Err(SceneError::malformed(file, format!("bend {index}"), found, expected))
            };
            let Some(mesh) = self.meshes.get(bend.mesh as usize) else {
                let expected = format!("a mesh below {}", self.meshes.len());
                return fail(format!("mesh {}", bend.mesh), &expected);
            };
            if std::mem::replace(&mut bends[bend.mesh as usize], true) {
                return fail(format!("mesh {}, which bends already", bend.mesh), "one bend at most");
            }
            if let Err((found, expected)) = check_times(bend.keys.iter().map(|key| key.time), 1) {
                return fail(found, expected);
            }
            let counts = (mesh.positions.len(), mesh.shading.normals.values.len());
            for key in &bend.keys {
                let found = (key.positions.len(), key.normals.len());
                if found != counts {
                    let [found, expected] = [found, counts]
                        .map(|(positions, normals)| format!("{positions} positions and {normals} normals"));
                    return fail(found, &format!("the mesh's {expected}"));
                }
                if !key.positions.iter().chain(&key.normals).all(|vector| vector.is_finite()) {
                    return fail(format!("a vertex at {} s", key.time), "finite numbers");
                }
            }
        }
        Ok(())
    }
}

/// What is wrong, and what was expected.
type Fault = (String, &'static str);

impl Motion {
    /// Tells what is wrong with its curves.
    pub(in crate::scene) fn check(&self) -> Result<(), Fault> {
        for curve in [&self.translation, &self.scale].into_iter().flatten() {
            check_curve(curve, |value: &Vec3| value.is_finite(), |value| value.is_finite())?;
        }
        if let Some(curve) = &self.rotation {
            check_curve(
                curve,
                |turn: &Quat| turn.is_finite() && turn.length_squared() > 0.0,
                |slope| slope.is_finite(),
            )?;
        }
        check_times(self.visibility.iter().map(|(time, _)| *time), 0)
    }
}

fn check_curve<T>(
    curve: &Curve<T>,
    is_sound: impl Fn(&T) -> bool,
    is_finite: impl Fn(&T) -> bool,
) -> Result<(), Fault> {
    let sound = match curve {
        Curve::Spline(keys) => {
            check_times(keys.iter().map(|key| key.time), SPLINE)?;
            let is_shaped = |shape: [f32; 3]| shape.iter().all(|number| number.is_finite());
            keys.iter().all(|key| is_sound(&key.value) && is_shaped([key.tension, key.continuity, key.bias]))
        }
        Curve::Linear(keys) | Curve::Steps(keys) => {
            check_times(keys.iter().map(|key| key.0), 1)?;
            keys.iter().all(|key| is_sound(&key.1))
        }
        Curve::Hermite(keys) => {
            check_times(keys.iter().map(|key| key.time), 1)?;
            keys.iter().all(|key| is_sound(&key.value) && is_finite(&key.arriving) && is_finite(&key.leaving))
        }
    };
    let expected = "finite numbers, rotations of some length";
    if sound { Ok(()) } else { Err(("a value that is no transform".into(), expected)) }
}

fn check_times(times: impl ExactSizeIterator<Item = f64> + Clone, least: usize) -> Result<(), Fault> {
    if times.len() < least {
        let expected = if least == SPLINE { "four at least" } else { "one at least" };
        return Err((format!("{} key frames", times.len()), expected));
    }
    // NaN is not below the limit either.
    if !times.clone().all(|time| time.abs() <= FURTHEST) || !times.is_sorted() {
        return Err((
            "times that are not in order".into(),
            "times within 1e18 s, each no less than the one before",
        ));
    }
    Ok(())
}

#[cfg(test)]
#[path = "validate_tests.rs"]
mod tests;
