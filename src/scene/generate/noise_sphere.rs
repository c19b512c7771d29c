//! A sphere with a rough skin, a million small triangles of even size: what a scanned model is like, without its file.

use glam::{Affine3A, DVec3, Vec3};

use super::super::{Corners, Scene};
use super::{Aisles, Generator, geodesic};

/// `20 f^2` = 1,003,520 triangles.
const FREQUENCY: u32 = 224;
/// How far the skin goes up and down, as a share of the radius.
const ROUGH: f64 = 0.12;

pub(super) const NOISE_SPHERE: Generator = Generator {
    name: "noise-sphere",
    about: "rough sphere of about 1 m radius, 1,003,520 triangles of even size",
    generate: || generate(FREQUENCY),
    aisles: || Aisles::NONE,
};

fn generate(frequency: u32) -> Scene {
    let mut scene = Scene::new("noise-sphere");
    let mut mesh = geodesic("skin", 1.0, frequency);
    for position in &mut mesh.positions {
        let out = position.as_dvec3();
        *position = (out * (1.0 + ROUGH * noise(out))).as_vec3();
    }
    let mut mesh = super::super::Mesh::new(mesh.name, mesh.positions, mesh.triangles);
    mesh.shading.normals = Corners::of_vertices(normals(&mesh.positions, &mesh.triangles));
    let mesh = scene.add_mesh(mesh);
    scene.add_node(None, "noise-sphere", Affine3A::IDENTITY, Some(mesh));
    scene
}

/// The sum of the triangles' normals about each vertex, each as long as its triangle is large.
pub(super) fn normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|vertex| normals[*vertex as usize] += normal);
    }
    // Tiny meshes have tiny normals, whose squares would vanish.
    normals.into_iter().map(Vec3::normalize_or_zero).collect()
}

/// Five octaves of values on a lattice, within -1 and 1.
fn noise(at: DVec3) -> f64 {
    let octave = |octave: i32| {
        let scale = f64::from(1 << octave);
        lattice(at * (3.0 * scale) + f64::from(octave) * 17.3) / scale
    };
    (0..5).map(octave).sum::<f64>() / 1.9375
}

/// Values hashed at whole coordinates, between -1 and 1, and eased in between.
pub(super) fn lattice(at: DVec3) -> f64 {
    let low = at.floor();
    let share = at - low;
    let ease = share * share * (DVec3::splat(3.0) - share * 2.0);
    let value = |corner: usize| {
        let bit = |axis: usize| (corner >> axis & 1) as f64;
        let [x, y, z] = [low.x + bit(0), low.y + bit(1), low.z + bit(2)].map(|number| number as i64 as u64);
        let seed = x.wrapping_mul(0x9E37_79B9)
            ^ y.wrapping_mul(0x85EB_CA6B) << 20
            ^ z.wrapping_mul(0xC2B2_AE35) << 40;
        super::super::SplitMix64::new(seed).between(-1.0, 1.0)
    };
    let weight = |corner: usize| {
        let side = |axis: usize| if corner >> axis & 1 == 1 { ease[axis] } else { 1.0 - ease[axis] };
        side(0) * side(1) * side(2)
    };
    (0..8).map(|corner| value(corner) * weight(corner)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_skin_is_rough_and_stays_within_its_bounds() {
        let scene = generate(20);
        scene.validate().unwrap();
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.triangles.len(), 8000);
        let radii: Vec<f32> = mesh.positions.iter().map(|position| position.length()).collect();
        let (least, most) = radii.iter().fold((f32::MAX, 0.0_f32), |(l, m), r| (l.min(*r), m.max(*r)));
        assert!(least > 0.88 && most < 1.12 && most - least > 0.1, "{least} to {most}");
        let outward =
            mesh.positions.iter().zip(&mesh.shading.normals.values).filter(|(p, n)| p.dot(**n) > 0.0);
        assert!(
            outward.count() == mesh.positions.len(),
            "a radial displacement this small folds nothing over"
        );
    }

    #[test]
    fn noise_is_even_across_the_cells_of_its_lattice() {
        let wall = DVec3::new(2.0, 0.3, 0.7);
        let step = DVec3::X * 1e-7;
        assert!((lattice(wall - step) - lattice(wall + step)).abs() < 1e-6);
        assert_ne!(lattice(wall), lattice(wall + DVec3::X));
    }
}
