//! Textures of the stand-ins: few functions of a hash, so that they are the same everywhere.

use glam::DVec3;

use super::super::noise_sphere::lattice;
use crate::scene::Texture;

/// A picture of a colour for each place, from 0 to 255.
pub(super) fn picture(name: &str, width: u32, height: u32, colour: impl Fn(f64, f64) -> [f64; 3]) -> Texture {
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| colour(f64::from(x), f64::from(y)).map(|part| part.round() as u8));
    Texture { name: name.to_owned(), width, height, pixels: pixels.collect() }
}

/// Slabs of two colours of marble, so many across.
pub(super) fn marble(name: &str, size: u32, slabs: f64, colours: [[f64; 3]; 2]) -> Texture {
    picture(name, size, size, move |x, y| {
        let (u, v) = (x / f64::from(size) * slabs, y / f64::from(size) * slabs);
        let colour = colours[((u as u32 + v as u32) % 2) as usize];
        let vein =
            lattice(DVec3::new(u * 2.0, v * 2.0, 3.0)) + 0.5 * lattice(DVec3::new(u * 5.0, v * 5.0, 9.0));
        let seam = u.fract().min(v.fract()) < 0.02;
        let light = if seam { 0.6 } else { 0.85 + 0.1 * vein.abs() };
        colour.map(|part| part * light)
    })
}

/// A painting: bands of two colours that swing about a middle.
pub(super) fn painting(name: &str, seed: f64, colours: [[f64; 3]; 2]) -> Texture {
    picture(name, 512, 512, move |x, y| {
        let (u, v) = (x / 128.0, y / 128.0);
        let swing = lattice(DVec3::new(u, v, seed)) * 2.0 + (u - 2.0).hypot(v - 2.0) * 1.5;
        let share = (swing.fract() - 0.5).abs() * 2.0;
        let [from, to] = colours;
        [0, 1, 2].map(|part| from[part] * (1.0 - share) + to[part] * share)
    })
}

/// Rows of windows on a wall, some lit; the picture is one storey of four.
pub(super) fn facade(name: &str, seed: f64, wall: [f64; 3]) -> Texture {
    picture(name, 256, 256, move |x, y| {
        let (u, v) = (x / 64.0, y / 64.0);
        let within = (0.2..0.8).contains(&u.fract()) && (0.15..0.75).contains(&v.fract());
        let lit = lattice(DVec3::new(u.floor(), v.floor(), seed)) > 0.35;
        let stain = 1.0 + 0.06 * lattice(DVec3::new(u * 3.0, v * 3.0, seed + 1.0));
        match (within, lit) {
            (true, true) => [235.0, 215.0, 150.0],
            (true, false) => [50.0, 62.0, 80.0],
            _ => wall.map(|part| part * stain),
        }
    })
}
