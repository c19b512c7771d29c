//! Meshes of a glTF file that bend: by skins, whose vertices follow several nodes, and by morph targets (glTF 2.0 sec. 3.7.2.2
//! and 3.7.3).
//!
//! Both become key frames of vertices, straight from one to the next. Weights of morph targets that go straight do so
//! exactly; what turns is given more key frames between the file's own until no vertex is further than [`CLOSE`] from
//! where it should be halfway, or there are [`HALVINGS`] times two of them. A skinned mesh stands in the world's own
//! space, so it is placed by a node of its own. One whose key frames would be too many stands still, with a warning.

use glam::{Affine3A, DVec3, Mat3, Mat4, Vec3};
use gltf::animation::{Interpolation, Property};

use super::super::animation::FURTHEST;
use super::super::{Bend, BendKey, Curve, Mesh, Scene, SceneError};
use super::gltf_buffers::Buffers;
use super::gltf_motion::{curve, frames};

/// How near a vertex must come to its way, as a share of the mesh's diagonal.
const CLOSE: f64 = 1e-3;
/// How often the way from one of the file's key frames to the next may be halved.
const HALVINGS: u32 = 5;
/// The most vertices, and nodes that have to be placed for them, that all key frames of a mesh may have together: 384 MB.
const MOST: usize = 1 << 24;

/// Vertices of a mesh that came with one of its primitives.
pub(super) struct Block {
    /// The primitive, by number in the mesh.
    pub(super) primitive: usize,
    /// The first of the vertices, and how many.
    pub(super) first: usize,
    pub(super) count: usize,
}

/// Where the vertices of a mesh are at any time.
struct Body {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    /// For each morph target its weight, as x, and what it adds to positions and normals.
    targets: Vec<(Curve<Vec3>, Vec<Vec3>, Vec<Vec3>)>,
    /// The joints of the skin: nodes of the scene, and what takes vertices to each one's space.
    joints: Vec<(u32, Affine3A)>,
    /// For each vertex the joints it follows, by number, and how much.
    follows: Vec<([u16; 4], [f32; 4])>,
}

/// Has all shown meshes bend that do; `blocks` are those of each of the document's meshes.
pub(super) fn read(
    document: &gltf::Document,
    buffers: &Buffers<'_>,
    placed: &[Option<u32>],
    blocks: &[Vec<Block>],
    scene: &mut Scene,
) {
    for node in document.nodes() {
        let (Some(own), Some(mesh)) = (placed[node.index()], node.mesh()) else { continue };
        let is_morphed = mesh.primitives().any(|part| part.morph_targets().len() > 0);
        if node.skin().is_none() && !is_morphed {
            continue;
        }
        let body = read_body(&node, &mesh, document, buffers, placed, &blocks[mesh.index()], scene);
        let bent = body.map_err(|error| error.to_string()).and_then(|(body, times)| {
            let keys = key_frames(scene, &body, times).ok_or("it has too many key frames")?;
            let mut vectors = keys.iter().flat_map(|key| key.positions.iter().chain(&key.normals));
            if !vectors.all(|vector| vector.is_finite()) {
                return Err("a vertex would be nowhere".to_owned());
            }
            put(scene, own, node.skin().is_some(), keys);
            Ok(())
        });
        if let Err(fault) = bent {
            let name = node.name().unwrap_or("");
            scene.warnings.push(format!("node {} {name:?} does not bend: {fault}", node.index()));
        }
    }
}

/// Gives the node a mesh that bends: its own, if nobody else has it.
fn put(scene: &mut Scene, own: u32, skinned: bool, keys: Vec<BendKey>) {
    let Some(mut mesh) = scene.nodes[own as usize].mesh else { return };
    let is_shared = scene.nodes.iter().filter(|node| node.mesh == Some(mesh)).count() > 1;
    let old = &scene.meshes[mesh as usize];
    let mut shading = old.shading.clone();
    shading.normals.values.clone_from(&keys[0].normals);
    let shape = Mesh::new(old.name.clone(), keys[0].positions.clone(), old.triangles.clone());
    let shape = Mesh { shading, ..shape };
    if is_shared {
        mesh = scene.add_mesh(shape);
    } else {
        scene.meshes[mesh as usize] = shape;
    }
    scene.nodes[own as usize].mesh = Some(mesh).filter(|_| !skinned);
    if skinned {
        let name = scene.nodes[own as usize].name.clone();
        scene.add_node(None, name, Affine3A::IDENTITY, Some(mesh));
    }
    if let [first, .., last] = &keys[..] {
        let animation = &mut scene.animation;
        // Where nodes move too, all this is within their time.
        if animation.is_still() {
            (animation.start, animation.end) = (first.time, last.time);
        } else if animation.motions.is_empty() {
            animation.start = animation.start.min(first.time);
            animation.end = animation.end.max(last.time);
        }
        animation.frames = frames(animation);
        animation.bends.push(Bend { mesh, keys });
    }
}

/// The key frames of a body at some times, and between them as many as it needs; one if it never changes.
fn key_frames(scene: &Scene, body: &Body, times: Vec<f64>) -> Option<Vec<BendKey>> {
    let each = body.positions.len() + scene.nodes.len();
    if times.len().max(1).checked_mul(each)? > MOST {
        return None;
    }
    let Some(first) = times.first() else { return Some(vec![body.at(scene, 0.0)]) };
    let mut keys = vec![body.at(scene, *first)];
    let size =
        keys[0].positions.iter().fold(Vec3::ZERO, |most, at| most.max((*at - keys[0].positions[0]).abs()));
    let close = f64::from(size.length()) * CLOSE;
    for time in &times[1..] {
        // A stack of key frames to come, the nearest on top, each with how often its way was halved.
        let mut coming = vec![(body.at(scene, *time), 0)];
        while let Some((next, halvings)) = coming.pop() {
            let last = &keys[keys.len() - 1];
            let half = body.at(scene, f64::midpoint(last.time, next.time));
            let is_close =
                last.positions.iter().zip(&next.positions).zip(&half.positions).all(|((a, b), found)| {
                    let straight = (a.as_dvec3() + b.as_dvec3()) * 0.5;
                    straight.distance(DVec3::from(*found)) <= close
                });
            let room = (keys.len() + coming.len() + times.len()) * each < MOST;
            if is_close || halvings == HALVINGS || !room {
                keys.push(next);
            } else {
                coming.push((next, halvings + 1));
                coming.push((half, halvings + 1));
            }
        }
    }
    Some(keys)
}

impl Body {
    fn at(&self, scene: &Scene, time: f64) -> BendKey {
        let (mut positions, mut normals) = (self.positions.clone(), self.normals.clone());
        for (weight, moved, turned) in &self.targets {
            let weight = weight.at(time).unwrap_or_default().x as f32;
            positions.iter_mut().zip(moved).for_each(|(at, by)| *at += *by * weight);
            normals.iter_mut().zip(turned).for_each(|(normal, by)| *normal += *by * weight);
        }
        if !self.follows.is_empty() {
            let world = scene.pose(time).world;
            let joints: Vec<Affine3A> =
                self.joints.iter().map(|(node, bind)| world[*node as usize] * *bind).collect();
            let turns: Vec<Mat3> = joints.iter().map(|joint| cofactors(joint.matrix3.into())).collect();
            let sum = |(which, how): &([u16; 4], [f32; 4]), of: &dyn Fn(usize) -> Vec3| {
                which.iter().zip(how).map(|(joint, how)| of(usize::from(*joint)) * *how).sum::<Vec3>()
            };
            for (at, follows) in positions.iter_mut().zip(&self.follows) {
                *at = sum(follows, &|joint| joints[joint].transform_point3(*at));
            }
            for (normal, follows) in normals.iter_mut().zip(&self.follows) {
                *normal = sum(follows, &|joint| turns[joint] * *normal);
            }
        }
        BendKey { time, positions, normals }
    }
}

/// The inverse transpose times the determinant, which takes normals along with their surface and never divides.
fn cofactors(matrix: Mat3) -> Mat3 {
    let [x, y, z] = [matrix.x_axis, matrix.y_axis, matrix.z_axis];
    Mat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}

/// Reads what bends a node's mesh, and the times at which it says something, in order.
fn read_body(
    node: &gltf::Node<'_>,
    mesh: &gltf::Mesh<'_>,
    document: &gltf::Document,
    buffers: &Buffers<'_>,
    placed: &[Option<u32>],
    blocks: &[Block],
    scene: &Scene,
) -> Result<(Body, Vec<f64>), SceneError> {
    let shape =
        &scene.meshes[scene.nodes[placed[node.index()].unwrap_or(0) as usize].mesh.unwrap_or(0) as usize];
    let (vertices, normals) = (shape.positions.len(), shape.shading.normals.values.len());
    let parts: Vec<gltf::Primitive<'_>> = mesh.primitives().collect();
    let mut body = Body {
        positions: shape.positions.clone(),
        normals: shape.shading.normals.values.clone(),
        targets: Vec::new(),
        joints: Vec::new(),
        follows: Vec::new(),
    };
    let rest = node.weights().or_else(|| mesh.weights()).unwrap_or(&[]);
    let targets = parts.iter().map(|part| part.morph_targets().len()).max().unwrap_or(0);
    for target in 0..targets {
        let weight = Vec3::X * rest.get(target).copied().unwrap_or(0.0);
        let still = Curve::Steps(vec![(0.0, weight)]);
        body.targets.push((still, vec![Vec3::ZERO; vertices], vec![Vec3::ZERO; normals]));
    }
    for block in blocks {
        let part = &parts[block.primitive];
        for (target, (_, moved, turned)) in part.morph_targets().zip(&mut body.targets) {
            for (accessor, values) in [(target.positions(), moved), (target.normals(), turned)] {
                let Some(accessor) = accessor else { continue };
                let read = buffers.positions(&accessor)?;
                let into = values.iter_mut().skip(block.first).take(block.count);
                into.zip(read).for_each(|(value, by)| *value = Vec3::from(by));
            }
        }
    }
    let mut times: Vec<f64> = Vec::new();
    let channels =
        document.animations().next().into_iter().flat_map(|played| played.channels().collect::<Vec<_>>());
    for channel in channels {
        let (target, sampler) = (channel.target(), channel.sampler());
        if target.property() == Property::MorphTargetWeights && target.node().index() == node.index() {
            let read = buffers.numbers(&sampler.input())?;
            let weights = buffers.numbers(&sampler.output())?;
            let kind = sampler.interpolation();
            buffers.check_keys(&sampler.output(), kind, &read, weights.len() / targets.max(1))?;
            let each = weights.chunks_exact(targets.max(1)).map(<[f32]>::to_vec).collect::<Vec<_>>();
            for (number, (weight, ..)) in body.targets.iter_mut().enumerate() {
                let values: Vec<Vec3> = each.iter().map(|all| Vec3::X * all[number]).collect();
                *weight = curve(kind, &read, &values);
            }
            add_times(&mut times, &read, kind);
        } else if node.skin().is_some() && target.property() != Property::MorphTargetWeights {
            add_times(&mut times, &buffers.numbers(&sampler.input())?, sampler.interpolation());
        }
    }
    if let Some(skin) = node.skin() {
        read_skin(&skin, &parts, buffers, placed, blocks, &mut body)?;
    }
    times.retain(|time| time.abs() <= FURTHEST);
    times.sort_by(f64::total_cmp);
    times.dedup();
    Ok((body, times))
}

/// A step is kept as sharp as times are told: it has a key frame right before it.
fn add_times(times: &mut Vec<f64>, read: &[f32], kind: Interpolation) {
    times.extend(read.iter().map(|time| f64::from(*time)));
    if kind == Interpolation::Step {
        times.extend(read.iter().skip(1).map(|time| f64::from(*time).next_down()));
    }
}

fn read_skin(
    skin: &gltf::Skin<'_>,
    parts: &[gltf::Primitive<'_>],
    buffers: &Buffers<'_>,
    placed: &[Option<u32>],
    blocks: &[Block],
    body: &mut Body,
) -> Result<(), SceneError> {
    let fault = |found: String, expected: String| {
        Err(SceneError::malformed("skin", format!("skin {}", skin.index()), found, expected))
    };
    let nodes: Vec<_> = skin.joints().map(|joint| placed.get(joint.index()).copied().flatten()).collect();
    let binds = match skin.inverse_bind_matrices() {
        Some(accessor) => buffers.matrices(&accessor)?,
        None => vec![Mat4::IDENTITY.to_cols_array(); nodes.len()],
    };
    if binds.len() < nodes.len() {
        return fault(format!("{} matrices", binds.len()), format!("one for each of {} joints", nodes.len()));
    }
    for (node, bind) in nodes.iter().zip(binds) {
        let Some(node) = *node else {
            return fault("a joint that is not shown".into(), "one that is".into());
        };
        body.joints.push((node, Affine3A::from_mat4(Mat4::from_cols_array(&bind))));
    }
    body.follows = vec![([0; 4], [0.0; 4]); body.positions.len()];
    for block in blocks {
        let part = &parts[block.primitive];
        let get = |semantic: gltf::Semantic| part.get(&semantic);
        let (Some(joints), Some(weights)) = (get(gltf::Semantic::Joints(0)), get(gltf::Semantic::Weights(0)))
        else {
            return fault("a primitive without joints or weights".into(), "both".into());
        };
        let (joints, weights) = (buffers.joints(&joints)?, buffers.fours(&weights)?);
        if joints.len() != block.count || weights.len() != block.count {
            return fault(
                format!("{} joints and {} weights", joints.len(), weights.len()),
                format!("{} of each", block.count),
            );
        }
        if let Some(joint) = joints.iter().flatten().find(|joint| usize::from(**joint) >= nodes.len()) {
            return fault(format!("joint {joint}"), format!("one below {}", nodes.len()));
        }
        for (follows, (joints, weights)) in
            body.follows[block.first..].iter_mut().zip(joints.into_iter().zip(weights))
        {
            let total: f32 = weights.iter().sum();
            // They should add up to 1; shares of 8 bits do so nearly.
            let share = if total > 0.0 { total.recip() } else { 0.0 };
            *follows = (joints, weights.map(|weight| weight * share));
        }
    }
    Ok(())
}

#[cfg(test)]
#[path = "gltf_bend_tests.rs"]
mod tests;
