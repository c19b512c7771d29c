//! A scene as an AFF file, with its textures as PPM files beside it.
//!
//! What is read back is the same scene as far as AFF can say it: the same triangles, primitives, materials, lights,
//! view, and motion. Each mesh is written where it is placed, once for each of its materials; names of meshes are not
//! kept, nor what no triangle uses. What AFF cannot say is told as warnings.

use std::fmt::Write as _;

use glam::{DVec3, Vec3};

use super::super::super::{Scene, Shape};
use super::super::ppm;
use finishes::Finishes;
use names::Names;

mod curves;
mod finishes;
mod meshes;
mod names;
mod transforms;

/// A scene, ready to be written to files.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// The AFF file.
    pub text: String,
    /// The files of its textures, which belong beside it: name and bytes.
    pub pictures: Vec<(String, Vec<u8>)>,
    /// What AFF cannot say.
    pub warnings: Vec<String>,
}

/// Writes a valid scene as AFF. The names of its textures' files begin with `stem`.
pub fn to_aff(scene: &Scene, stem: &str) -> Written {
    let mut out = Out {
        text: format!("# {:?}, written by apportion {}\n", scene.name, env!("CARGO_PKG_VERSION")),
        names: Names::of(scene, stem),
        finishes: Finishes::default(),
        warnings: scene.warnings.clone(),
    };
    out.look(scene);
    out.nodes(scene);
    out.primitives(scene);
    out.motions(scene);
    out.tell_finishes(scene);
    let textures = scene.textures.iter().zip(&out.names.textures);
    let pictures = textures.map(|(texture, name)| (name.clone(), ppm::encode(texture))).collect();
    Written { text: out.text, pictures, warnings: out.warnings }
}

/// What has been written so far.
struct Out {
    text: String,
    names: Names,
    finishes: Finishes,
    warnings: Vec<String>,
}

impl Out {
    /// Background, lights and view.
    fn look(&mut self, scene: &Scene) {
        for (word, colour) in [("b", scene.background), ("am", scene.ambient)] {
            if let Some(colour) = colour {
                self.statement(word, &colour.to_array());
            }
        }
        if scene.background.is_none() || scene.ambient.is_none() {
            self.warnings.push(
                "background or ambient light are left to whoever shows it: in AFF they are black and white then"
                    .to_owned(),
            );
        }
        if let Some(view) = &scene.view {
            self.text.push_str("v\n");
            for (word, vector) in [("from", view.eye), ("at", view.look), ("up", view.up)] {
                self.statement(word, &vector.to_array());
            }
            let degrees = f64::from(view.fov_y).to_degrees();
            // The scene knows neither; readers want both.
            self.text.push_str(&format!("angle {degrees}\nhither 0.001\nresolution 800 600\n"));
        }
        for (number, light) in scene.lights.iter().enumerate() {
            let motion = scene.animation.lights.iter().find(|(light, _)| *light as usize == number);
            let word = match motion {
                Some((_, motion)) => format!("la {}", self.names.motions[*motion as usize]),
                None => "l".to_owned(),
            };
            self.statement(&word, &[light.position.to_array(), light.colour.to_array()].concat());
        }
        let animation = &scene.animation;
        if animation.frames > 0 {
            self.text.push_str(&format!("a {} {} {}\n", animation.start, animation.end, animation.frames));
        }
    }

    fn nodes(&mut self, scene: &Scene) {
        let mut motions = vec![None; scene.nodes.len()];
        for (node, motion) in &scene.animation.followers {
            motions[*node as usize] = Some(*motion);
        }
        let mut bends = vec![None; scene.meshes.len()];
        for bend in &scene.animation.bends {
            bends[bend.mesh as usize] = Some(bend);
        }
        // Nodes to begin with, and how many braces to close after those below them.
        let mut stack: Vec<Result<u32, usize>> = scene.roots.iter().rev().map(|root| Ok(*root)).collect();
        let mut placed = vec![0; scene.meshes.len()];
        while let Some(step) = stack.pop() {
            let number = match step {
                Ok(number) => number,
                Err(braces) => {
                    self.text.push_str(&"}\n".repeat(braces));
                    continue;
                }
            };
            let node = &scene.nodes[number as usize];
            let braces = match motions[number as usize] {
                Some(motion) => {
                    let _ = writeln!(self.text, "x {} {{", self.names.motions[motion as usize]);
                    1
                }
                None => self.transform(&node.transform),
            };
            if let Some(mesh) = node.mesh {
                placed[mesh as usize] += 1;
                self.mesh(scene, &scene.meshes[mesh as usize], bends[mesh as usize]);
            }
            stack.push(Err(braces));
            stack.extend(node.children.iter().rev().map(|child| Ok(*child)));
        }
        let shared = placed.iter().filter(|times| **times > 1).count();
        if shared > 0 {
            self.warnings.push(format!("{shared} meshes are placed several times: written out each time"));
        }
    }

    fn primitives(&mut self, scene: &Scene) {
        for primitive in &scene.primitives {
            self.finish(scene, primitive.material);
            let (word, ends) = match primitive.shape {
                Shape::Sphere(sphere) => ("s", vec![(sphere.centre, sphere.radius)]),
                Shape::Cone(cone) => ("c", vec![(cone.base, cone.base_radius), (cone.tip, cone.tip_radius)]),
            };
            let numbers = ends.into_iter().flat_map(|(at, radius)| [at.x, at.y, at.z, radius]);
            self.statement(word, &numbers.collect::<Vec<_>>());
        }
    }

    /// A word and its numbers on a line.
    fn statement(&mut self, word: &str, numbers: &[f32]) {
        self.text.push_str(word);
        self.numbers(numbers);
        self.text.push('\n');
    }

    /// Numbers, each after a blank, with as many digits as it takes to read the same f32 back.
    fn numbers(&mut self, numbers: &[f32]) {
        for number in numbers {
            let size = number.abs();
            let _ = match size == 0.0 || (1e-4..1e7).contains(&size) {
                true => write!(self.text, " {number}"),
                false => write!(self.text, " {number:e}"),
            };
        }
    }

    fn vector(&mut self, vector: Vec3) {
        self.numbers(&vector.to_array());
    }

    /// As [`Out::numbers`], so that the same f64 is read back.
    fn doubles(&mut self, vector: DVec3) {
        for number in vector.to_array() {
            let _ = write!(self.text, " {number:e}");
        }
    }
}

#[cfg(test)]
mod tests;
