//! A furnished room of 75,000 polygons (stand-in for the one of Parker et al. 1999, sec. 4 and Fig. 16, which was never
//! published): a table with a pot, a glass and a metal ball, chairs, a shelf of books, a lamp, a picture, a mirror, a
//! carpet. As theirs it has glass, textures and more than one light. Every triangle that the furniture leaves over is
//! in the carpet. Metres; y is up, the floor at 0, the middle of the room at the origin.

use glam::{Affine3A, Vec3};

use super::super::{Material, Materials, Mesh, PointLight, Scene, SplitMix64, View};
use super::place::turned_y;
use super::{Aisles, Generator, cuboid, cylinder};

pub(super) mod parts;

/// "75,000 polygons" (Parker et al. sec. 4).
const TRIANGLES: usize = 75_000;
/// Half of the room's length (x) and width (z), and its height.
const HALF: Vec3 = Vec3::new(3.0, 2.7, 2.5);
/// Top of the table.
const TABLE: f32 = 0.75;

pub(super) const ROOM: Generator = Generator {
    name: "room",
    about: "furnished room, 75,000 triangles, glass, mirror, textures, two lights (stand-in: Parker et al. sec. 4)",
    generate,
    aisles: || Aisles::NONE,
};

/// A scene in the making.
struct Room {
    scene: Scene,
    root: u32,
}

impl Room {
    fn material(&mut self, material: Material) -> u32 {
        self.scene.add_material(material)
    }

    fn mesh(&mut self, mut mesh: Mesh, material: u32) -> u32 {
        mesh.shading.materials = Materials::One(material);
        self.scene.add_mesh(mesh)
    }

    fn put(&mut self, name: &str, mesh: u32, place: Affine3A) {
        self.scene.add_node(Some(self.root), name, place, Some(mesh));
    }

    /// A mesh of its own for one place.
    fn add(&mut self, mesh: Mesh, material: u32, place: Vec3) {
        let name = mesh.name.clone();
        let mesh = self.mesh(mesh, material);
        self.put(&name, mesh, Affine3A::from_translation(place));
    }
}

fn generate() -> Scene {
    let mut scene = Scene::new("room");
    let root = scene.add_node(None, "room", Affine3A::IDENTITY, None);
    let mut room = Room { scene, root };
    shell(&mut room);
    table(&mut room);
    shelf(&mut room);
    lamp_and_mirror(&mut room);
    let left = TRIANGLES - room.scene.instances().1;
    let wool = room.material(Material::matt("wool", Vec3::new(0.35, 0.09, 0.1)));
    room.add(parts::carpet(2.6, 1.9, left), wool, Vec3::new(-0.5, 0.0, -0.3));
    let mut scene = room.scene;
    scene.lights = vec![
        PointLight { position: Vec3::new(0.3, 2.55, 0.2), colour: Vec3::new(0.6, 0.57, 0.5) },
        PointLight { position: Vec3::new(2.6, 1.9, -1.6), colour: Vec3::new(0.28, 0.3, 0.36) },
    ];
    let eye = Vec3::new(2.4, 1.65, 2.2);
    scene.view = Some(View { eye, look: Vec3::new(-0.75, 0.75, -0.75), up: Vec3::Y, fov_y: 0.95 });
    scene
}

/// Floor, walls, ceiling, and a picture.
fn shell(room: &mut Room) {
    let boards = parts::boards();
    room.scene.textures.push(boards);
    room.scene.textures.push(parts::painting());
    let wood = Material { texture: Some(0), ..Material::polished("boards", Vec3::ONE, 1.4) };
    let (wood, plaster) = (room.material(wood), Material::matt("plaster", Vec3::new(0.78, 0.76, 0.7)));
    let paint = room.material(Material { texture: Some(1), ..Material::matt("painting", Vec3::ONE) });
    let (plaster, frame) =
        (room.material(plaster), room.material(Material::matt("frame", Vec3::new(0.3, 0.2, 0.08))));
    let corner = |x: f32, y: f32, z: f32| Vec3::new(x * HALF.x, y * HALF.y, z * HALF.z);
    let floor =
        [corner(-1.0, 0.0, 1.0), corner(1.0, 0.0, 1.0), corner(1.0, 0.0, -1.0), corner(-1.0, 0.0, -1.0)];
    room.add(parts::sheet("floor", floor, [3.0, 2.5]), wood, Vec3::ZERO);
    let walls = [
        ("ceiling", [(-1.0, 1.0, -1.0), (1.0, 1.0, -1.0), (1.0, 1.0, 1.0), (-1.0, 1.0, 1.0)]),
        ("back", [(-1.0, 0.0, -1.0), (1.0, 0.0, -1.0), (1.0, 1.0, -1.0), (-1.0, 1.0, -1.0)]),
        ("front", [(1.0, 0.0, 1.0), (-1.0, 0.0, 1.0), (-1.0, 1.0, 1.0), (1.0, 1.0, 1.0)]),
        ("left", [(-1.0, 0.0, 1.0), (-1.0, 0.0, -1.0), (-1.0, 1.0, -1.0), (-1.0, 1.0, 1.0)]),
        ("right", [(1.0, 0.0, -1.0), (1.0, 0.0, 1.0), (1.0, 1.0, 1.0), (1.0, 1.0, -1.0)]),
    ];
    for (name, corners) in walls {
        let corners = corners.map(|(x, y, z)| corner(x, y, z));
        room.add(parts::sheet(name, corners, [1.0, 1.0]), plaster, Vec3::ZERO);
    }
    let place = Vec3::new(-0.6, 1.2, -HALF.z + 0.03);
    room.add(cuboid("frame", Vec3::new(1.3, 0.9, 0.05)), frame, place);
    let (low, high) = (Vec3::new(-0.58, 0.07, 0.03), Vec3::new(0.58, 0.83, 0.03));
    let canvas = [low, Vec3::new(high.x, low.y, low.z), high, Vec3::new(low.x, high.y, low.z)];
    room.add(parts::sheet("painting", canvas, [1.0, 1.0]), paint, place);
}

/// The table, what is on it, and four chairs.
fn table(room: &mut Room) {
    let oak = room.material(Material::polished("oak", Vec3::new(0.42, 0.25, 0.12), 1.45));
    let steel = room.material(Material::metal("steel", Vec3::new(0.75, 0.76, 0.78), 120));
    let glass = Material { absorption: Vec3::new(2.0, 0.4, 0.8), ..Material::dielectric("glass", 1.5) };
    let glass = room.material(glass);
    let glaze = room.material(Material {
        highlight: Vec3::splat(0.4),
        exponent: 80,
        ..Material::polished("glaze", Vec3::new(0.1, 0.22, 0.45), 1.6)
    });
    let middle = Vec3::new(-0.5, 0.0, -0.3);
    room.add(cuboid("table top", Vec3::new(1.5, 0.04, 0.9)), oak, middle + Vec3::Y * (TABLE - 0.04));
    let leg = room.mesh(cylinder("leg", 0.03, TABLE - 0.04, 128), oak);
    for (x, z) in [(-0.68, -0.38), (0.68, -0.38), (-0.68, 0.38), (0.68, 0.38)] {
        room.put("leg", leg, Affine3A::from_translation(middle + Vec3::new(x, 0.0, z)));
    }
    let ball = parts::ball(0.11, 14);
    let on_table = |x: f32, z: f32, up: f32| middle + Vec3::new(x, TABLE + up, z);
    // A little above the top, so that no two surfaces lie in one another.
    room.add(ball.clone(), glass, on_table(0.3, 0.2, 0.111));
    room.add(ball, steel, on_table(0.02, -0.12, 0.111));
    room.add(parts::lathe("pot", &parts::POT, 120, 6), glaze, on_table(-0.38, 0.08, 0.001));
    room.add(parts::lathe("vase", &parts::VASE, 96, 6), glass, on_table(0.45, -0.2, 0.001));
    let seat = room.mesh(cuboid("seat", Vec3::new(0.42, 0.04, 0.42)), oak);
    let back = room.mesh(cuboid("back", Vec3::new(0.42, 0.45, 0.03)), oak);
    let leg = room.mesh(cylinder("chair leg", 0.018, 0.44, 64), steel);
    for (x, z, angle) in [(-0.35, 0.75, 3.3), (0.4, 0.7, 2.9), (-0.3, -0.75, 0.1), (0.35, -0.8, -0.2)] {
        let chair = turned_y(middle + Vec3::new(x, 0.0, z), angle);
        room.put("seat", seat, chair * Affine3A::from_translation(Vec3::Y * 0.44));
        room.put("back", back, chair * Affine3A::from_translation(Vec3::new(0.0, 0.5, -0.2)));
        for (x, z) in [(-0.18, -0.18), (0.18, -0.18), (-0.18, 0.18), (0.18, 0.18)] {
            room.put("chair leg", leg, chair * Affine3A::from_translation(Vec3::new(x, 0.0, z)));
        }
    }
}

/// A shelf with books on the left wall.
fn shelf(room: &mut Room) {
    let pine = room.material(Material::matt("pine", Vec3::new(0.6, 0.45, 0.25)));
    let board = room.mesh(cuboid("board", Vec3::new(0.3, 0.025, 1.6)), pine);
    let side = room.mesh(cuboid("side", Vec3::new(0.3, 2.0, 0.025)), pine);
    let place = Vec3::new(-HALF.x + 0.16, 0.0, -0.9);
    for z in [-0.8125, 0.8125] {
        room.put("side", side, Affine3A::from_translation(place + Vec3::Z * z));
    }
    let covers = [[0.5, 0.1, 0.1], [0.1, 0.3, 0.2], [0.12, 0.16, 0.4], [0.6, 0.55, 0.4], [0.25, 0.2, 0.18]];
    let covers = covers.map(|colour| room.material(Material::matt("cover", Vec3::from(colour))));
    let mut random = SplitMix64::new(75);
    for level in 0..5 {
        let y = 0.05 + 0.45 * level as f32;
        room.put("board", board, Affine3A::from_translation(place + Vec3::Y * y));
        let mut z = -0.78;
        while z < 0.7 {
            let (thick, high, deep) =
                (random.between(0.015, 0.06), random.between(0.2, 0.36), random.between(0.15, 0.25));
            let size = Vec3::new(deep as f32, high as f32, thick as f32);
            let at = place + Vec3::new(0.0, y + 0.026, z + size.z / 2.0);
            room.add(cuboid("book", size), covers[random.below(covers.len())], at);
            // Some are lent.
            z += size.z + if random.below(12) == 0 { 0.12 } else { 0.002 };
        }
    }
}

fn lamp_and_mirror(room: &mut Room) {
    let brass = room.material(Material::metal("brass", Vec3::new(0.75, 0.58, 0.28), 40));
    let linen = room.material(Material::matt("linen", Vec3::new(0.85, 0.8, 0.65)));
    let silver = room.material(Material::metal("mirror", Vec3::splat(0.9), 1000));
    let place = Vec3::new(-2.4, 0.0, -2.1);
    room.add(parts::lathe("lamp stand", &parts::STAND, 64, 4), brass, place);
    room.add(parts::lathe("lamp shade", &parts::SHADE, 96, 4), linen, place);
    room.add(cuboid("mirror", Vec3::new(1.0, 1.5, 0.03)), silver, Vec3::new(1.4, 0.7, -HALF.z + 0.02));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_are_75_000_triangles_all_within_the_walls() {
        let scene = generate();
        scene.validate().unwrap();
        assert_eq!(scene.instances().1, TRIANGLES);
        let bounds = scene.bounds();
        assert!(bounds.min.cmpge(Vec3::new(-HALF.x, 0.0, -HALF.z) - 0.02).all(), "{bounds:?}");
        assert!(bounds.max.cmple(HALF + 0.02).all(), "{bounds:?}");
        assert!(scene.lights.len() == 2 && scene.textures.len() == 2);
        assert!(
            scene.meshes.iter().all(|mesh| mesh.shading.materials.of(0).is_some()),
            "all is made of something"
        );
    }
}
