//! The city that the robots walk through: 24 blocks of skyscrapers about a square.

use glam::{Affine3A, Vec2, Vec3};

use super::super::room::parts::sheet;
use super::Stage;
use super::pictures::{facade, picture};
use crate::scene::{Corners, Material, Mesh, SplitMix64};

/// From the middle of one street to the next, in metres.
pub(super) const PITCH: f32 = 40.0;
/// Blocks across and along.
pub(super) const BLOCKS: i32 = 5;
/// Edge of a block, in metres: what is left are streets.
const BLOCK: f32 = 28.0;
/// Towers of a block, across and along, and the storeys each is stacked of.
const TOWERS: (u32, u32) = (2, 8);

/// Adds ground and towers: `2 + 24 * 4 * 8 * 12` triangles, the paper's 9,218.
pub(super) fn city(stage: &mut Stage) {
    let asphalt = picture("asphalt", 256, 256, |x, y| {
        let grain = super::super::noise_sphere::lattice(glam::DVec3::new(x * 0.7, y * 0.7, 1.0));
        let stripe = (x - 128.0).abs() < 3.0 && (y / 64.0).fract() < 0.5;
        if stripe { [200.0, 195.0, 170.0] } else { [78.0 + 10.0 * grain; 3] }
    });
    let walls = [[150.0, 140.0, 125.0], [110.0, 120.0, 135.0], [160.0, 110.0, 85.0]];
    let textures = walls.iter().zip(0..).map(|(wall, seed)| facade("facade", f64::from(seed) * 7.0, *wall));
    stage.scene.textures.push(asphalt);
    stage.scene.textures.extend(textures);
    let road = stage.material(Material { texture: Some(0), ..Material::matt("asphalt", Vec3::ONE) });
    let walls = [1, 2, 3].map(|texture| {
        let glass = Material::polished("facade", Vec3::ONE, 1.5);
        stage.material(Material { texture: Some(texture), ..glass })
    });
    let half = PITCH * BLOCKS as f32;
    let corners =
        [(-half, half), (half, half), (half, -half), (-half, -half)].map(|(x, z)| Vec3::new(x, 0.0, z));
    stage.set(sheet("ground", corners, [2.0 * BLOCKS as f32; 2]), road, Vec3::ZERO);
    let mut random = SplitMix64::new(9_218);
    for (x, z) in (0..BLOCKS).flat_map(|x| (0..BLOCKS).map(move |z| (x - BLOCKS / 2, z - BLOCKS / 2))) {
        if (x, z) == (0, 0) {
            continue;
        }
        let block = Vec3::new(x as f32, 0.0, z as f32) * PITCH;
        for tower in 0..TOWERS.0 * TOWERS.0 {
            let side = |at: u32| (at as f32 - 0.5) * BLOCK * 0.52;
            let place = block + Vec3::new(side(tower % 2), 0.0, side(tower / 2));
            let wall = walls[random.below(walls.len())];
            stage.put(stack(&mut random), wall, Affine3A::from_translation(place));
        }
    }
}

/// A tower of boxes, each set back from the one below.
fn stack(random: &mut SplitMix64) -> Mesh {
    let (mut positions, mut triangles, mut coordinates) = (Vec::new(), Vec::new(), Vec::new());
    let (mut width, mut depth, mut foot) = (random.between(10.0, 13.5), random.between(10.0, 13.5), 0.0);
    for storey in 0..TOWERS.1 {
        let height = if storey == 0 { random.between(12.0, 26.0) } else { random.between(2.0, 11.0) };
        let (low, high) = ((-width / 2.0, foot, -depth / 2.0), (width / 2.0, foot + height, depth / 2.0));
        let corner = |x: bool, y: bool, z: bool| {
            let pick = |top: bool, low: f64, high: f64| (if top { high } else { low }) as f32;
            Vec3::new(pick(x, low.0, high.0), pick(y, low.1, high.1), pick(z, low.2, high.2))
        };
        let around = [(false, true), (true, true), (true, false), (false, false)];
        let mut face = |corners: [Vec3; 4], size: Vec2| {
            let first = positions.len() as u32;
            positions.extend(corners);
            triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            // A picture is 12 m of wall.
            let size = size / 12.0;
            coordinates.extend([Vec2::new(0.0, size.y), size, Vec2::new(size.x, 0.0), Vec2::ZERO]);
        };
        for side in 0..4 {
            let ((x, z), (u, w)) = (around[side], around[(side + 1) % 4]);
            let across = if side % 2 == 0 { width } else { depth };
            let corners = [corner(x, false, z), corner(u, false, w), corner(u, true, w), corner(x, true, z)];
            face(corners, Vec2::new(across as f32, height as f32));
        }
        // Roofs and floors have no windows: a place on the wall between them.
        let flat = |top: bool| around.map(|(x, z)| corner(x, top, z));
        let [a, b, c, d] = flat(false);
        face(flat(true), Vec2::ZERO);
        face([d, c, b, a], Vec2::ZERO);
        foot += height;
        width *= random.between(0.72, 0.98);
        depth *= random.between(0.72, 0.98);
    }
    let mut mesh = Mesh::new("tower", positions, triangles);
    mesh.shading.coordinates = Corners::of_vertices(coordinates);
    mesh
}
