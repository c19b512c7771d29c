//! What a scene holds, in numbers.

use serde::Serialize;

use super::{Flock, Materials, Mesh, Node, Primitive, Scene};

/// What a scene holds. How unbalanced the tree over it is, the statistics of the structure room say.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Description {
    /// Name of the scene.
    pub name: String,
    /// Nodes of the graph.
    pub nodes: usize,
    /// Depth of the deepest node; roots are at depth 1, an empty scene has depth 0.
    pub depth: usize,
    /// How many nodes there are at each depth; entry `i` is for depth `i + 1`.
    pub depths: Vec<usize>,
    /// The most children any node has.
    pub widest_fan_out: usize,
    /// Mean number of children of the nodes that have any; 0 if none has.
    pub mean_fan_out: f64,
    /// Meshes.
    pub meshes: usize,
    /// Triangles of all meshes, each mesh once.
    pub unique_triangles: usize,
    /// Nodes that place a mesh.
    pub instances: usize,
    /// Triangles in the world: a mesh counts each time it is placed.
    pub instanced_triangles: usize,
    /// Spheres and cones in the world: a flock counts each time it is placed.
    pub primitives: usize,
    /// Materials.
    pub materials: usize,
    /// Textures.
    pub textures: usize,
    /// Lights.
    pub lights: usize,
    /// How many frames whoever animated it asks for; 0 if nothing moves.
    pub frames: u32,
    /// How long its animation is, in seconds.
    pub seconds: f64,
    /// Nodes that follow a motion.
    pub moving: usize,
    /// Meshes that change shape.
    pub bending: usize,
    /// Their triangles, each mesh once.
    pub bending_triangles: usize,
    /// Least corner of the world, in metres; absent if there is nothing in it.
    pub bounds_min: Option<[f32; 3]>,
    /// Greatest corner of the world, in metres; absent if there is nothing in it.
    pub bounds_max: Option<[f32; 3]>,
    /// Bytes of vertices, triangles, nodes, primitives, key frames and what they are seen with in memory, without
    /// names.
    pub bytes: usize,
    /// How skinny half of the triangles are at most: longest edge over the height on it, 1.15 for an
    /// equilateral one. In the world, triangles without area left out; 0 if there are none.
    pub aspect_p50: f64,
    /// The same for nine tenths.
    pub aspect_p90: f64,
    /// The same for ninety-nine hundredths.
    pub aspect_p99: f64,
    /// Triangles without area, in the world.
    pub zero_area: usize,
}

/// Describes a valid scene.
pub fn describe(scene: &Scene) -> Description {
    let depths = depths(scene);
    let parents = scene.nodes.iter().filter(|node| !node.children.is_empty()).count();
    let children: usize = scene.nodes.iter().map(|node| node.children.len()).sum();
    let (instances, instanced_triangles) = scene.instances();
    let bounds = Some(scene.bounds()).filter(|bounds| !bounds.is_empty());
    let unique_triangles = scene.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
    let vertices: usize = scene.meshes.iter().map(|mesh| mesh.positions.len()).sum();
    let bent = scene.animation.bends.iter().map(|bend| &scene.meshes[bend.mesh as usize]);
    let bending_triangles = bent.map(|mesh| mesh.triangles.len()).sum();
    let aspects = aspects(scene);
    let percentile = |share: f64| match aspects.len() {
        0 => 0.0,
        count => aspects[((count - 1) as f64 * share).round() as usize],
    };
    Description {
        name: scene.name.clone(),
        nodes: scene.nodes.len(),
        depth: depths.len(),
        depths,
        widest_fan_out: scene.nodes.iter().map(|node| node.children.len()).max().unwrap_or(0),
        mean_fan_out: if parents == 0 { 0.0 } else { children as f64 / parents as f64 },
        meshes: scene.meshes.len(),
        unique_triangles,
        instances,
        instanced_triangles,
        primitives: scene.primitives_placed(),
        materials: scene.materials.len(),
        textures: scene.textures.len(),
        lights: scene.lights.len(),
        frames: scene.animation.frames,
        seconds: scene.animation.end - scene.animation.start,
        moving: scene.animation.followers.len(),
        bending: scene.animation.bends.len(),
        bending_triangles,
        bounds_min: bounds.map(|bounds| bounds.min.to_array()),
        bounds_max: bounds.map(|bounds| bounds.max.to_array()),
        bytes: 12 * (vertices + unique_triangles)
            + 4 * children
            + size_of::<Node>() * scene.nodes.len()
            + size_of::<Primitive>() * scene.primitives.len()
            + scene.flocks.iter().map(flock_bytes).sum::<usize>()
            + scene.meshes.iter().map(shading_bytes).sum::<usize>()
            + scene.textures.iter().map(|texture| 3 * texture.pixels.len()).sum::<usize>()
            + scene.animation.bytes(),
        aspect_p50: percentile(0.5),
        aspect_p90: percentile(0.9),
        aspect_p99: percentile(0.99),
        zero_area: instanced_triangles - aspects.len(),
    }
}

fn flock_bytes(flock: &Flock) -> usize {
    size_of::<Primitive>() * flock.primitives.len() + 4 * flock.nodes.len()
}

fn shading_bytes(mesh: &Mesh) -> usize {
    let (normals, coordinates) = (&mesh.shading.normals, &mesh.shading.coordinates);
    let corners =
        [&normals.triangles, &coordinates.triangles].into_iter().flatten().map(Vec::len).sum::<usize>();
    let materials = if let Materials::Each(each) = &mesh.shading.materials { each.len() } else { 0 };
    12 * (normals.values.len() + corners) + 8 * coordinates.values.len() + 4 * materials
}

fn depths(scene: &Scene) -> Vec<usize> {
    let mut depth = vec![0usize; scene.nodes.len()];
    let mut histogram = Vec::new();
    for index in scene.depth_first() {
        let above = scene.nodes[index as usize].parent.map_or(0, |parent| depth[parent as usize]);
        depth[index as usize] = above + 1;
        histogram.resize(histogram.len().max(above + 1), 0);
        histogram[above] += 1;
    }
    histogram
}

/// Aspects of all triangles in the world that have an area, least first.
fn aspects(scene: &Scene) -> Vec<f64> {
    let mut aspects = Vec::new();
    for (node, world) in scene.nodes.iter().zip(scene.world_transforms()) {
        let Some(mesh) = node.mesh.map(|mesh| &scene.meshes[mesh as usize]) else { continue };
        // In f64, so that placing a triangle neither gives it an area nor takes it away.
        let turn = world.matrix3.as_dmat3();
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|vertex| turn * mesh.positions[vertex as usize].as_dvec3());
            let twice_area = (b - a).cross(c - a).length();
            let longest =
                (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
            // Below this the area is rounding.
            if twice_area > longest * 1e-12 {
                aspects.push(longest / twice_area);
            }
        }
    }
    aspects.sort_unstable_by(f64::total_cmp);
    aspects
}
