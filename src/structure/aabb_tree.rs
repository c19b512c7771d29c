//! The scene graph's own tree of boxes, with pointers to children: what Paper I sec. 3 and Paper II
//! sec. 2 traverse.

use super::{NO_SOURCE, TreeError};
use crate::geometry::Aabb;
use crate::scene::Scene;

/// A node of an [`AabbTree`].
#[derive(Clone, Debug)]
pub struct AabbTreeNode {
    /// The box around everything at and below the node, in the world, in metres.
    pub bounds: Aabb,
    /// The nodes below, by index.
    pub children: Vec<u32>,
    /// The mesh placed at this node, by index into the scene's. A node with a mesh and children both
    /// must have its own mesh counted as soon as it is not outside, whatever becomes of the children.
    pub mesh: Option<u32>,
    /// Triangles of that mesh.
    pub triangles: u32,
    /// The scene node this one stands for, or [`NO_SOURCE`].
    pub source: u32,
}

/// A tree of axis-aligned boxes with one node for each scene node that has any geometry at or below it.
///
/// Invariants: node 0 is the root; a parent comes before its children; each box holds those below it.
/// A scene with several roots gets one more node over them; a scene without geometry gives an empty
/// tree.
#[derive(Clone, Debug, Default)]
pub struct AabbTree {
    /// All nodes, depth-first, the root first.
    pub nodes: Vec<AabbTreeNode>,
}

impl AabbTree {
    /// Builds the tree of a valid scene (see [`Scene::validate`]). No recursion, so any depth will do.
    pub fn build(scene: &Scene) -> Self {
        let order = scene.depth_first();
        let mut bounds = scene.world_bounds();
        // From the last to the first, each node is whole before it is added to its parent.
        for index in order.iter().rev() {
            if let Some(parent) = scene.nodes[*index as usize].parent {
                bounds[parent as usize] = bounds[parent as usize].union(bounds[*index as usize]);
            }
        }
        let has_any = |index: &u32| !bounds[*index as usize].is_empty();
        let mut nodes: Vec<AabbTreeNode> = Vec::with_capacity(scene.nodes.len() + 1);
        let roots = scene.roots.iter().filter(|root| has_any(root)).count();
        if roots > 1 {
            let all = scene.roots.iter().fold(Aabb::EMPTY, |all, root| all.union(bounds[*root as usize]));
            let children = Vec::with_capacity(roots);
            nodes.push(AabbTreeNode { bounds: all, children, mesh: None, triangles: 0, source: NO_SOURCE });
        }
        let mut place = vec![0; scene.nodes.len()];
        for index in order.into_iter().filter(has_any) {
            let node = &scene.nodes[index as usize];
            let here = nodes.len() as u32;
            place[index as usize] = here;
            match node.parent {
                Some(parent) => nodes[place[parent as usize] as usize].children.push(here),
                None if roots > 1 => nodes[0].children.push(here),
                None => {}
            }
            let mesh = node.mesh.filter(|mesh| !scene.meshes[*mesh as usize].positions.is_empty());
            nodes.push(AabbTreeNode {
                bounds: bounds[index as usize],
                children: Vec::new(),
                mesh,
                triangles: mesh.map_or(0, |mesh| scene.meshes[mesh as usize].triangles.len() as u32),
                source: index,
            });
        }
        Self { nodes }
    }

    /// Checks the invariants.
    ///
    /// # Errors
    /// [`TreeError`] naming the first node that breaks one.
    pub fn validate(&self) -> Result<(), TreeError> {
        let mut has_parent = vec![false; self.nodes.len()];
        for (index, node) in self.nodes.iter().enumerate() {
            for child in node.children.iter().map(|child| *child as usize) {
                let Some(below) = self.nodes.get(child) else {
                    return Err(TreeError::new(index, format!("child {child} does not exist")));
                };
                if child <= index {
                    return Err(TreeError::new(index, format!("child {child} does not come after it")));
                }
                if std::mem::replace(&mut has_parent[child], true) {
                    return Err(TreeError::new(child, "has two parents"));
                }
                if !node.bounds.contains(&below.bounds) {
                    return Err(TreeError::new(
                        index,
                        format!("its box does not hold that of child {child}"),
                    ));
                }
            }
        }
        match has_parent.iter().skip(1).position(|has| !has) {
            Some(lost) => Err(TreeError::new(lost + 1, "has no parent")),
            None => Ok(()),
        }
    }
}
