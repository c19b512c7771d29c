//! A small scene for each of BART's eight potential stresses (P3-01), of what makes the stress and little else, so that
//! what breaks under one is seen apart from what breaks under others. The paper names the stresses; the scenes are made
//! up here. Four seconds each; only a floor, if anything, stands still.

use std::f64::consts::{PI, TAU};

use glam::{Affine3A, Quat, Vec3};

use super::super::{cuboid, geodesic};
use super::art::art;
use super::{Aisles, Generator, Stage, about, flight, gaze, smooth, turning};
use crate::scene::{Curve, Material, Motion, PointLight, Scene, SplitMix64};

macro_rules! stress {
    ($const:ident, $name:literal, $about:literal, $scene:expr) => {
        pub(in crate::scene::generate) const $const: Generator = Generator {
            name: $name,
            about: $about,
            generate: || $scene(Show::new($name)),
            aisles: || Aisles::NONE,
        };
    };
}
stress!(
    S1,
    "bart-stress-1",
    "stress 1, hierarchical animation: a mobile of 62 balls, six joints deep; 4 s",
    mobile
);
stress!(
    S2,
    "bart-stress-2",
    "stress 2, unorganised animation: 4,096 triangles that fly each on its own; 4 s",
    swarm
);
stress!(
    S3,
    "bart-stress-3",
    "stress 3, a teapot in a stadium: a fine ball turns amid a coarse bowl; 4 s",
    stadium
);
stress!(S4, "bart-stress-4", "stress 4, low coherence: the camera is elsewhere in every frame; 4 s", leaps);
stress!(
    S5,
    "bart-stress-5",
    "stress 5, a large working set: a ball of 327,680 triangles turns; 4 s",
    |show| ball(show, 128)
);
stress!(S5_SMALL, "bart-stress-5-small", "the same as bart-stress-5 of 5,120 triangles; 4 s", |show| ball(
    show, 16
));
stress!(
    S6,
    "bart-stress-6",
    "stress 6, volumes that overlap: 600 long sticks through one place, turning; 4 s",
    sheaf
);
stress!(
    S7,
    "bart-stress-7",
    "stress 7, a changing distribution: 200 balls in a field come to one place; 4 s",
    crowd
);
stress!(S8, "bart-stress-8", "stress 8, many lights: 16 over 30 balls, which turn; 4 s", lamps);

/// End of the animation, in seconds; it starts at 0.
const END: f64 = 4.0;

/// A scene in the making, with what all of them have.
struct Show {
    stage: Stage,
    coat: u32,
}

impl Show {
    fn new(name: &str) -> Self {
        let mut stage = Stage::new(name);
        let animation = &mut stage.scene.animation;
        (animation.start, animation.end, animation.frames) = (0.0, END, 100);
        let coat = stage.material(Material::matt("coat", Vec3::new(0.75, 0.6, 0.4)));
        Self { stage, coat }
    }

    /// A smooth ball of `20 f^2` triangles.
    fn ball(&mut self, radius: f32, frequency: u32) -> u32 {
        self.stage.mesh(smooth(geodesic("ball", radius.into(), frequency)), self.coat)
    }

    fn light(&mut self, position: Vec3, strength: f32) {
        self.stage.scene.lights.push(PointLight { position, colour: Vec3::splat(strength) });
    }

    fn floor(&mut self, width: f32) {
        let slate = self.stage.material(Material::matt("slate", Vec3::new(0.4, 0.42, 0.45)));
        let slab = cuboid("floor", Vec3::new(width, 0.1, width));
        self.stage.set(slab, slate, Vec3::Y * -0.1);
    }

    /// Has the camera go a quarter of a circle about a point, so far from it and so much above.
    fn go_round(mut self, middle: Vec3, away: f32, above: f32) -> Scene {
        let keys: Vec<(f64, Vec3, Vec3)> = (-1..=5)
            .map(|second| {
                let eye = middle + about(Vec3::Y, f64::from(second) * PI / 8.0) * Vec3::new(0.0, above, away);
                (f64::from(second), eye, middle)
            })
            .collect();
        self.stage.fly(flight(&keys), 0.8);
        self.stage.scene
    }

    /// Turns about an axis all the time, so many times, from an angle on.
    fn turn(name: String, axis: Vec3, from: f64, times: f64) -> Motion {
        let quarters = (times.abs() * 6.0).ceil() as i32;
        let keys = (-1..=quarters + 1).map(|key| {
            let share = f64::from(key) / f64::from(quarters);
            (share * END, about(axis, from + share * times * TAU))
        });
        Motion { name, rotation: turning(keys), ..Motion::default() }
    }
}

fn mobile(mut show: Show) -> Scene {
    let ball = show.ball(0.16, 3);
    let root = show.stage.moving(None, Show::turn("mobile".into(), Vec3::Y, 0.0, 0.5), None);
    let mut above = vec![root];
    for depth in 0..5 {
        let reach = 1.5 * 0.62_f32.powi(depth);
        above = above
            .iter()
            .flat_map(|parent| [(*parent, -reach), (*parent, reach)])
            .enumerate()
            .map(|(number, (parent, side))| {
                let place = Affine3A::from_translation(Vec3::new(side, -0.7, 0.0));
                let hook = show.stage.scene.add_node(Some(parent), "hook", place, None);
                let times = if number % 2 == 0 { 1.0 } else { -1.5 };
                let turn = Show::turn(format!("joint {depth} {number}"), Vec3::Y, number as f64, times);
                let swell =
                    [(0.0, 1.0), (END / 2.0, 0.8), (END, 1.1)].map(|(at, size)| (at, Vec3::splat(size)));
                let motion = Motion { scale: Some(Curve::Linear(swell.into())), ..turn };
                show.stage.moving(Some(hook), motion, Some(ball))
            })
            .collect();
    }
    show.light(Vec3::new(4.0, 6.0, 5.0), 0.9);
    show.go_round(Vec3::new(0.0, -1.7, 0.0), 8.0, 1.0)
}

fn swarm(mut show: Show) -> Scene {
    // The first mesh, as its bend says.
    let (mesh, bend) = art(6);
    let coat = show.coat;
    show.stage.set(mesh, coat, Vec3::ZERO);
    show.stage.scene.animation.bends.push(bend);
    show.light(Vec3::new(3.0, 6.0, 4.0), 0.9);
    show.go_round(Vec3::new(0.0, 2.1, 0.0), 4.5, 0.6)
}

fn stadium(mut show: Show) -> Scene {
    let teapot = show.ball(0.3, 24);
    show.stage.moving(None, Show::turn("teapot".into(), Vec3::Y, 0.0, 1.0), Some(teapot));
    let concrete = show.stage.material(Material::matt("concrete", Vec3::new(0.5, 0.5, 0.48)));
    let block = show.stage.mesh(cuboid("block", Vec3::new(24.0, 30.0, 20.0)), concrete);
    for number in 0..32 {
        let turn = about(Vec3::Y, f64::from(number) / 32.0 * TAU);
        let place = Affine3A::from_rotation_translation(turn, turn * Vec3::new(0.0, -4.0, 120.0));
        show.stage.scene.add_node(None, "block", place, Some(block));
    }
    let lawn = show.stage.material(Material::matt("lawn", Vec3::new(0.2, 0.4, 0.15)));
    show.stage.set(cuboid("lawn", Vec3::new(260.0, 0.1, 260.0)), lawn, Vec3::Y * -0.4);
    show.light(Vec3::new(40.0, 90.0, 30.0), 0.9);
    show.go_round(Vec3::ZERO, 1.6, 0.5)
}

/// Balls of a radius that stand about on a floor, in a square so wide, and turn.
fn stand(show: &mut Show, radius: f32, count: u32, width: f32) {
    let ball = show.ball(radius, 4);
    let mut random = SplitMix64::new(u64::from(count));
    let half = f64::from(width) * 0.5;
    for number in 0..count {
        let place = [random.between(-half, half) as f32, radius, random.between(-half, half) as f32];
        let place = Affine3A::from_translation(place.into());
        let stand = show.stage.scene.add_node(None, "stand", place, None);
        let turn = Show::turn(format!("ball {number}"), Vec3::Y, f64::from(number), 1.0);
        show.stage.moving(Some(stand), turn, Some(ball));
    }
    show.floor(width * 1.5);
}

fn leaps(mut show: Show) -> Scene {
    stand(&mut show, 0.6, 40, 14.0);
    show.light(Vec3::new(5.0, 12.0, 4.0), 0.9);
    let mut random = SplitMix64::new(4);
    // As many places as frames, and more between two of them than any shows again.
    let eyes: Vec<(f64, Vec3)> = (0..100)
        .map(|frame| {
            let turn = about(Vec3::Y, random.between(0.0, TAU));
            let (above, away) = (random.between(2.0, 9.0) as f32, random.between(8.0, 14.0) as f32);
            (f64::from(frame) * END / 100.0, turn * Vec3::new(0.0, above, away))
        })
        .collect();
    let gazes: Vec<(f64, Quat)> = eyes.iter().map(|(at, eye)| (*at, gaze(*eye, Vec3::Y))).collect();
    let camera = Motion {
        name: "camera".into(),
        translation: Some(Curve::Steps(eyes)),
        rotation: Some(Curve::Steps(gazes)),
        ..Motion::default()
    };
    show.stage.fly(camera, 0.8);
    show.stage.scene
}

fn ball(mut show: Show, frequency: u32) -> Scene {
    let ball = show.ball(1.0, frequency);
    show.stage.moving(None, Show::turn("ball".into(), Vec3::Y, 0.0, 0.5), Some(ball));
    show.light(Vec3::new(3.0, 5.0, 4.0), 0.9);
    show.go_round(Vec3::ZERO, 3.0, 0.4)
}

fn sheaf(mut show: Show) -> Scene {
    let coat = show.coat;
    let stick = show.stage.mesh(cuboid("stick", Vec3::new(0.03, 6.0, 0.03)), coat);
    let root = show.stage.moving(None, Show::turn("sheaf".into(), Vec3::Y, 0.0, 0.5), None);
    let mut random = SplitMix64::new(6);
    for number in 0..600 {
        let axis = about(Vec3::Y, random.between(0.0, TAU)) * Vec3::X;
        let turn = Show::turn(format!("stick {number}"), axis, random.between(0.0, TAU), 0.5);
        let hub = show.stage.moving(Some(root), turn, None);
        let place: [f32; 3] = std::array::from_fn(|_| random.between(-0.8, 0.8) as f32);
        let place = Affine3A::from_translation(Vec3::from(place) - Vec3::Y * 3.0);
        show.stage.scene.add_node(Some(hub), "stick", place, Some(stick));
    }
    show.light(Vec3::new(4.0, 7.0, 5.0), 0.9);
    show.go_round(Vec3::ZERO, 8.0, 1.0)
}

fn crowd(mut show: Show) -> Scene {
    let ball = show.ball(0.25, 2);
    let mut random = SplitMix64::new(7);
    for number in 0..200 {
        let mut place = |half: f64| -> Vec3 {
            Vec3::new(random.between(-half, half) as f32, 0.25, random.between(-half, half) as f32)
        };
        let (from, to) = (place(20.0), place(2.5));
        let way = Curve::Linear(vec![(0.0, from), (END, to)]);
        let motion = Motion { name: format!("ball {number}"), translation: Some(way), ..Motion::default() };
        show.stage.moving(None, motion, Some(ball));
    }
    show.floor(60.0);
    show.light(Vec3::new(10.0, 20.0, 8.0), 0.9);
    show.go_round(Vec3::Y * 0.3, 14.0, 6.0)
}

fn lamps(mut show: Show) -> Scene {
    stand(&mut show, 0.6, 30, 12.0);
    for number in 0..16_u32 {
        let place = about(Vec3::Y, f64::from(number) / 16.0 * TAU) * Vec3::new(0.0, 6.0, 5.0);
        show.light(place, 1.2 / 16.0);
    }
    show.go_round(Vec3::Y * 0.6, 11.0, 5.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use crate::scene::{by_name, describe};

    fn boxes(scene: &Scene, time: f64) -> Vec<Aabb> {
        let pose = scene.pose(time);
        scene
            .nodes
            .iter()
            .zip(&pose.world)
            .filter_map(|(node, world)| {
                let mesh = &scene.meshes[node.mesh? as usize];
                let corners = mesh.positions.iter().map(|at| world.transform_point3(*at));
                Some(corners.fold(Aabb::EMPTY, |all, at| all.union(Aabb { min: at, max: at })))
            })
            .collect()
    }

    #[test]
    fn each_is_what_its_stress_says() {
        let scene = |number: u32| by_name(&format!("bart-stress-{number}")).unwrap();
        for (number, triangles) in
            [11_160, 4_096, 11_916, 12_812, 327_680, 7_200, 16_012, 9_612].into_iter().enumerate()
        {
            let scene = scene(number as u32 + 1);
            scene.validate().unwrap();
            let holds = describe(&scene);
            assert_eq!(holds.instanced_triangles, triangles, "{number}");
            assert_eq!((holds.frames, holds.seconds), (100, END), "{number}");
            assert!(holds.moving + holds.bending > 0 && scene.view.is_some(), "{number}");
        }
        let depth = describe(&scene(1)).depth;
        assert!(depth >= 6, "{depth}");
        let size = |bounds: &Aabb| bounds.size().max_element();
        let stadium = boxes(&scene(3), 0.0);
        let all = stadium.iter().copied().fold(Aabb::EMPTY, Aabb::union);
        assert!(size(&stadium[0]) < 0.01 * size(&all), "the teapot is small in the stadium");
        let leaps = scene(4);
        let eyes: Vec<Vec3> = leaps.animation.times(20).map(|at| leaps.pose(at).view.unwrap().eye).collect();
        let far = eyes.windows(2).filter(|pair| pair[0].distance(pair[1]) > 4.0).count();
        assert!(far > 15, "the camera leaps {far} of 19 times");
        let sheaf = boxes(&scene(6), 1.0);
        let meets = |a: &Aabb, b: &Aabb| a.min.cmple(b.max).all() && b.min.cmple(a.max).all();
        let overlaps = sheaf.iter().filter(|other| meets(other, &sheaf[0])).count();
        assert!(overlaps > 500, "a stick's box meets those of {overlaps} of 600");
        let crowd = scene(7);
        let spread = |at: f64| -> f32 {
            let balls = boxes(&crowd, at).into_iter().filter(|bounds| size(bounds) < 1.0);
            size(&balls.fold(Aabb::EMPTY, Aabb::union))
        };
        assert!(spread(0.0) > 35.0 && spread(END) < 6.0, "{} to {} m", spread(0.0), spread(END));
        assert_eq!((scene(8).lights.len(), scene(1).lights.len()), (16, 1));
    }
}
