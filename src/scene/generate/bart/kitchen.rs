//! The kitchen (P3-02): a toy car drives through it, followed by the camera, which twice sees something else at once: the
//! car shoots past it at 7 s, and the table's edge hides all until 17 s.

use glam::{Affine3A, Vec3};

use super::super::room::parts::{POT, SHADE, VASE, ball, carpet, lathe, sheet};
use super::super::{cuboid, cylinder};
use super::car::car;
use super::pictures::{facade, marble, painting, picture};
use super::{Aisles, Generator, Stage, flight, pennant};
use crate::scene::{Material, PointLight, Scene, Texture};

/// Triangles (Table 1).
const TRIANGLES: usize = 110_561;
/// The far corner of the room, whose near one is at the origin, in metres.
const ROOM: Vec3 = Vec3::new(4.6, 2.5, 3.8);
/// The middle of the table, its half length and width, and how high its top reaches, from where.
const TABLE: Vec3 = Vec3::new(2.3, 0.0, 1.9);
const TABLE_HALF: Vec3 = Vec3::new(0.75, 0.0, 0.45);
const TOP: (f32, f32) = (0.72, 0.78);
/// What the lights give together, however many they are.
const BRIGHTNESS: f32 = 1.5;

/// Where the lights hang; the first so many shine.
const LIGHTS: [(f32, f32, f32); 10] = [
    (2.0, 1.85, 1.9),
    (2.6, 1.85, 1.9),
    (4.2, 2.3, 3.4),
    (0.4, 2.3, 0.9),
    (4.2, 2.3, 0.9),
    (0.4, 2.3, 3.4),
    (2.3, 2.4, 3.4),
    (2.3, 2.4, 0.5),
    (0.3, 2.4, 2.1),
    (4.3, 2.4, 2.1),
];

macro_rules! lit {
    ($const:ident, $name:literal, $lights:literal, $about:literal) => {
        pub(in crate::scene::generate) const $const: Generator = Generator {
            name: $name,
            about: $about,
            generate: || kitchen($name, $lights),
            aisles: || Aisles::NONE,
        };
    };
}
lit!(
    KITCHEN,
    "bart-kitchen",
    6,
    "BART's kitchen with a toy car, 110,561 triangles, 6 lights; 20 s (stand-in: Paper III, Kitchen)"
);
lit!(ONE, "bart-kitchen-1", 1, "the same by one light");
lit!(TWO, "bart-kitchen-2", 2, "the same by two lights");
lit!(THREE, "bart-kitchen-3", 3, "the same by three lights");
lit!(FOUR, "bart-kitchen-4", 4, "the same by four lights");
lit!(FIVE, "bart-kitchen-5", 5, "the same by five lights");
lit!(SIX, "bart-kitchen-6", 6, "the same by six lights, as it is");
lit!(SEVEN, "bart-kitchen-7", 7, "the same by seven lights");
lit!(EIGHT, "bart-kitchen-8", 8, "the same by eight lights");
lit!(NINE, "bart-kitchen-9", 9, "the same by nine lights");
lit!(TEN, "bart-kitchen-10", 10, "the same by ten lights");

fn kitchen(name: &str, lights: usize) -> Scene {
    let mut stage = Stage::new(name);
    let animation = &mut stage.scene.animation;
    (animation.start, animation.end, animation.frames) = (0.0, 20.0, 800);
    let wood = textures(&mut stage);
    walls(&mut stage);
    cupboards(&mut stage, wood);
    table(&mut stage, wood);
    stools(&mut stage, wood);
    car(&mut stage);
    let wool = stage.material(Material::matt("wool", Vec3::new(0.16, 0.22, 0.35)));
    let shelf = [Vec3::new(0.0, 1.5, 3.8), Vec3::new(0.5, 1.5, 3.8), Vec3::new(0.0, 1.5, 3.3)];
    stage.set(pennant("corner shelf", shelf), wood, Vec3::ZERO);
    // Whatever is left over is in the doormat.
    let left = TRIANGLES - stage.scene.instances().1;
    stage.set(carpet(0.9, 0.55, left), wool, Vec3::new(0.55, 0.0, 3.4));
    let share = Vec3::splat(BRIGHTNESS / lights as f32);
    stage.scene.lights = LIGHTS[..lights]
        .iter()
        .map(|(x, y, z)| PointLight { position: Vec3::new(*x, *y, *z), colour: share })
        .collect();
    fly(&mut stage);
    stage.scene
}

/// The eight pictures, the first of which is the floor's; tells the material of wood.
fn textures(stage: &mut Stage) -> u32 {
    let grain = |name: &str, colour: [f64; 3]| -> Texture {
        picture(name, 256, 256, move |x, y| {
            let along = super::super::noise_sphere::lattice(glam::DVec3::new(x * 0.25, y * 0.02, 5.0));
            colour.map(|part| part * (0.85 + 0.15 * along))
        })
    };
    stage.scene.textures = vec![
        marble("tiles", 512, 8.0, [[205.0, 200.0, 185.0], [150.0, 85.0, 60.0]]),
        grain("wood", [170.0, 120.0, 70.0]),
        grain("dark wood", [95.0, 60.0, 35.0]),
        picture("wallpaper", 256, 256, |x, y| {
            let dot = (x % 64.0 - 32.0).hypot(y % 64.0 - 32.0) < 8.0;
            if dot { [180.0, 150.0, 90.0] } else { [222.0, 212.0, 180.0] }
        }),
        marble("marble", 512, 2.0, [[190.0, 190.0, 195.0], [180.0, 182.0, 190.0]]),
        picture("garden", 512, 256, |x, y| {
            let hedge =
                150.0 + 30.0 * super::super::noise_sphere::lattice(glam::DVec3::new(x * 0.05, y * 0.05, 2.0));
            if y < hedge {
                [150.0 + y * 0.3, 190.0 + y * 0.2, 240.0]
            } else {
                [60.0, 120.0 - (y - 150.0) * 0.4, 45.0]
            }
        }),
        painting("picture", 3.0, [[200.0, 120.0, 50.0], [60.0, 90.0, 120.0]]),
        facade("blind", 11.0, [205.0, 200.0, 190.0]),
    ];
    stage.material(Material { texture: Some(1), ..Material::polished("wood", Vec3::ONE, 1.4) })
}

/// Walls, floor and ceiling: a few large triangles about many small ones (stress 3). A window, a picture, a blind.
fn walls(stage: &mut Stage) {
    let textured = |stage: &mut Stage, name: &str, texture: u32, index: f32| {
        stage.material(Material { texture: Some(texture), ..Material::polished(name, Vec3::ONE, index) })
    };
    let tiles = textured(stage, "tiles", 0, 1.5);
    let paper = textured(stage, "wallpaper", 3, 1.0);
    let white = stage.material(Material::matt("ceiling", Vec3::splat(0.8)));
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x, y, z) * ROOM;
    let sides = [
        ("floor", tiles, [(0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, 0.0)], [2.3, 1.9]),
        ("ceiling", white, [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0), (1.0, 1.0, 1.0), (0.0, 1.0, 1.0)], [1.0, 1.0]),
        ("back", paper, [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0), (0.0, 1.0, 0.0)], [4.0, 2.0]),
        ("front", paper, [(1.0, 0.0, 1.0), (0.0, 0.0, 1.0), (0.0, 1.0, 1.0), (1.0, 1.0, 1.0)], [4.0, 2.0]),
        ("left", paper, [(0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 1.0, 1.0)], [3.0, 2.0]),
        ("right", paper, [(1.0, 0.0, 0.0), (1.0, 0.0, 1.0), (1.0, 1.0, 1.0), (1.0, 1.0, 0.0)], [3.0, 2.0]),
    ];
    for (name, material, corners, times) in sides {
        stage.set(sheet(name, corners.map(|(x, y, z)| corner(x, y, z)), times), material, Vec3::ZERO);
    }
    let frame = stage.material(Material::polished("frame", Vec3::splat(0.75), 1.4));
    // On the left wall, seen from the right.
    let hung = [("window", 5, 1.5, 1.9, 0.9), ("picture", 6, 3.1, 1.6, 0.6), ("blind", 7, 0.9, 1.9, 0.7)];
    for (name, texture, z, y, size) in hung {
        let material = textured(stage, name, texture, 1.5);
        stage.set(
            cuboid("frame", Vec3::new(0.03, size * 0.8 + 0.08, size + 0.08)),
            frame,
            Vec3::new(0.02, y - size * 0.4 - 0.04, z),
        );
        let (low, high, near, far) = (y - size * 0.4, y + size * 0.4, z + size * 0.5, z - size * 0.5);
        let corners =
            [(low, near), (low, far), (high, far), (high, near)].map(|(y, z)| Vec3::new(0.04, y, z));
        stage.set(sheet(name, corners, [1.0; 2]), material, Vec3::ZERO);
    }
}

/// Along the back wall below and above, with doors and knobs; an oven, a fridge.
fn cupboards(stage: &mut Stage, wood: u32) {
    let steel = stage
        .material(Material { diffuse: Vec3::splat(0.1), ..Material::metal("steel", Vec3::splat(0.5), 150) });
    let top = stage.material(Material { texture: Some(4), ..Material::polished("marble", Vec3::ONE, 1.6) });
    let white = stage.material(Material::polished("enamel", Vec3::splat(0.75), 1.5));
    let knob = stage.mesh(ball(0.018, 5), steel);
    let put = |stage: &mut Stage, mesh: u32, name: &str, place: Vec3| {
        stage.scene.add_node(None, name, Affine3A::from_translation(place), Some(mesh));
    };
    for (low, height, depth) in [(0.08, 0.76, 0.56), (1.5, 0.7, 0.32)] {
        let body = stage.mesh(cuboid("cupboard", Vec3::new(0.6, height, depth)), wood);
        let door = stage.mesh(cuboid("door", Vec3::new(0.57, height - 0.04, 0.02)), wood);
        for column in 0..6 {
            let x = 0.4 + 0.62 * column as f32;
            put(stage, body, "cupboard", Vec3::new(x, low, depth / 2.0));
            put(stage, door, "door", Vec3::new(x, low + 0.02, depth + 0.012));
            put(stage, knob, "knob", Vec3::new(x + 0.22, low + height * 0.6, depth + 0.04));
        }
    }
    stage.set(cuboid("worktop", Vec3::new(3.74, 0.04, 0.62)), top, Vec3::new(1.95, 0.86, 0.31));
    stage.set(cuboid("fridge", Vec3::new(0.62, 1.8, 0.62)), white, Vec3::new(4.2, 0.02, 0.32));
    stage.set(cylinder("handle", 0.015, 0.6, 200), steel, Vec3::new(3.98, 0.8, 0.66));
    stage.set(
        lathe("sink", &[(0.02, 0.0), (0.2, 0.01), (0.22, 0.03), (0.23, 0.02)], 64, 4),
        steel,
        Vec3::new(1.2, 0.901, 0.32),
    );
    stage.set(lathe("kettle", &POT, 64, 5), steel, Vec3::new(2.6, 0.901, 0.3));
}

/// The table and what is on it, under two lamps.
fn table(stage: &mut Stage, wood: u32) {
    let steel = stage.material(Material::metal("table steel", Vec3::splat(0.65), 150));
    let china = stage.material(Material {
        highlight: Vec3::splat(0.4),
        exponent: 100,
        ..Material::polished("china", Vec3::new(0.8, 0.78, 0.72), 1.6)
    });
    let glass = stage.material(Material::dielectric("glass", 1.5));
    let dark = Material { texture: Some(2), ..Material::polished("table", Vec3::ONE, 1.5) };
    let dark = stage.material(dark);
    let size = Vec3::new(2.0 * TABLE_HALF.x, TOP.1 - TOP.0, 2.0 * TABLE_HALF.z);
    stage.set(cuboid("table top", size), dark, TABLE + Vec3::Y * TOP.0);
    let leg = stage.mesh(cylinder("leg", 0.03, TOP.0, 200), wood);
    let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
    for (x, z) in corners {
        let place = TABLE + Vec3::new(x * (TABLE_HALF.x - 0.08), 0.0, z * (TABLE_HALF.z - 0.08));
        stage.scene.add_node(None, "leg", Affine3A::from_translation(place), Some(leg));
    }
    let on = |x: f32, z: f32, up: f32| TABLE + Vec3::new(x, TOP.1 + up, z);
    let plate = lathe(
        "plate",
        &[(0.0, 0.0), (0.06, 0.0), (0.08, 0.012), (0.12, 0.02), (0.118, 0.024), (0.0, 0.01)],
        64,
        4,
    );
    let tumbler = lathe("glass", &VASE, 48, 3);
    let (plate, tumbler) = (stage.mesh(plate, china), stage.mesh(tumbler, glass));
    for (x, z) in [-0.45, 0.0, 0.45].into_iter().flat_map(|x| [-0.26, 0.26].map(|z| (x, z))) {
        stage.scene.add_node(None, "plate", Affine3A::from_translation(on(x, z, 0.001)), Some(plate));
        let place = Affine3A::from_scale_rotation_translation(
            Vec3::splat(0.7),
            glam::Quat::IDENTITY,
            on(x + 0.17, z * 0.6, 0.001),
        );
        stage.scene.add_node(None, "glass", place, Some(tumbler));
    }
    let glaze = stage.material(Material::polished("glaze", Vec3::new(0.1, 0.2, 0.42), 1.6));
    stage.set(lathe("pot", &POT, 120, 6), glaze, on(0.0, 0.02, 0.001));
    stage.set(lathe("vase", &VASE, 96, 6), glass, on(-0.64, 0.0, 0.001));
    let fruit =
        [[0.7, 0.25, 0.05], [0.5, 0.55, 0.08], [0.65, 0.08, 0.06], [0.75, 0.55, 0.1], [0.4, 0.5, 0.1]];
    for (number, colour) in fruit.into_iter().enumerate() {
        let skin = stage.material(Material::polished("fruit", Vec3::from(colour), 1.4));
        let (sin, cos) = (number as f64 * 1.257).sin_cos();
        stage.set(ball(0.045, 10), skin, on(0.58 + 0.08 * cos as f32, 0.08 * sin as f32, 0.046));
    }
    let shade = stage.mesh(lathe("shade", &SHADE, 96, 4), steel);
    for (x, y, z) in &LIGHTS[..2] {
        let place = Vec3::new(*x, y - 1.45, *z);
        stage.scene.add_node(None, "shade", Affine3A::from_translation(place), Some(shade));
    }
}

/// Four of them, with a ring between their legs.
fn stools(stage: &mut Stage, wood: u32) {
    let steel = stage.material(Material::metal("stool steel", Vec3::splat(0.6), 150));
    let seat = lathe(
        "seat",
        &[(0.0, 0.56), (0.15, 0.56), (0.17, 0.58), (0.16, 0.61), (0.1, 0.62), (0.0, 0.61)],
        64,
        4,
    );
    let ring = lathe("ring", &[(0.15, 0.2), (0.16, 0.2), (0.16, 0.21), (0.15, 0.21), (0.15, 0.2)], 64, 3);
    let (seat, ring) = (stage.mesh(seat, wood), stage.mesh(ring, steel));
    let leg = stage.mesh(cylinder("stool leg", 0.012, 0.57, 200), steel);
    for (x, z) in [(1.9, 1.15), (2.7, 1.15), (1.9, 2.75), (2.7, 2.75)] {
        let place = Vec3::new(x, 0.0, z);
        for mesh in [seat, ring] {
            let name = stage.scene.meshes[mesh as usize].name.clone();
            stage.scene.add_node(None, name, Affine3A::from_translation(place), Some(mesh));
        }
        for (x, z) in [(-0.11, -0.11), (0.11, -0.11), (-0.11, 0.11), (0.11, 0.11)] {
            let place = Affine3A::from_translation(place + Vec3::new(x, 0.0, z));
            stage.scene.add_node(None, "stool leg", place, Some(leg));
        }
    }
}

/// Down from a corner of the ceiling to the car, after it, up past the table's edge, and to the crash.
fn fly(stage: &mut Stage) {
    let at = |x: f32, y: f32, z: f32| Vec3::new(x, y, z);
    let edge = TABLE.x - TABLE_HALF.x - 0.045;
    stage.fly(
        flight(&[
            (-1.0, at(4.3, 2.35, 3.6), at(2.0, 0.5, 1.5)),
            (0.0, at(4.3, 2.35, 3.6), at(2.0, 0.5, 1.5)),
            (2.5, at(4.1, 1.3, 2.6), at(3.5, 0.3, 2.6)),
            (5.0, at(3.95, 0.25, 2.1), at(3.6, 0.05, 3.1)),
            (6.7, at(3.95, 0.16, 2.0), at(3.3, 0.08, 2.4)),
            (7.4, at(3.96, 0.16, 2.0), at(3.3, 0.08, 2.3)),
            (8.6, at(3.75, 0.3, 2.1), at(3.2, 0.05, 1.3)),
            (10.0, at(3.3, 0.34, 1.95), at(2.75, 0.05, 1.55)),
            (12.0, at(2.65, 0.3, 1.75), at(1.8, 0.05, 2.2)),
            (14.0, at(1.35, 0.4, 2.65), at(1.0, 0.05, 2.0)),
            (15.6, at(1.3, 0.4, 2.2), at(0.8, 0.05, 1.3)),
            (16.5, at(edge - 0.05, 0.6, 1.95), at(1.8, 0.68, 1.8)),
            (17.0, at(edge, 0.75, 1.88), at(2.3, 0.75, 1.88)),
            (17.3, at(edge, 0.92, 1.85), at(2.3, 0.8, 1.9)),
            (18.2, at(1.75, 1.3, 1.5), at(2.1, 0.3, 0.9)),
            (19.2, at(2.7, 0.95, 1.55), at(3.2, 0.1, 0.95)),
            (20.0, at(3.2, 0.5, 1.35), at(3.7, 0.08, 0.72)),
            (21.0, at(3.2, 0.5, 1.35), at(3.7, 0.08, 0.72)),
        ]),
        0.7,
    );
}

#[cfg(test)]
#[path = "kitchen_tests.rs"]
mod tests;
