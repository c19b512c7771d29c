//! Factories: stand-ins for the models of Papers I and II, which were never published.
//!
//! What the papers say, and these keep: Paper II sec. 2 has unbalanced trees of 3932, 1137 and 254
//! nodes; Paper I sec. 4 has a car factory of 184,000 polygons, a shop floor of 52,000 and a single
//! cell of 167,000, the last of few, finely tessellated parts that one navigates among. Node and
//! triangle counts are met exactly (triangles as placed, shared meshes counted each time). Paper I counts
//! the nodes of its three models as 3800, 188 and 1274: plans of their own meet those, and are alike otherwise.
//!
//! What they do not say, and is made up here: the plan. A hall holds lines of robot cells, the first
//! line much longer than the last, and a store of racks that takes up all nodes still wanting. Robots
//! are deep chains, racks and conveyors wide fans, so the tree is deep in places, wide in others and
//! nowhere balanced. All parts are closed meshes of real size, so they can be collided.

use super::{Aisles, Generator};

mod layout;
mod parts;

/// What sets one factory apart from another. Lengths in metres.
struct Plan {
    name: &'static str,
    /// Nodes of the finished graph.
    nodes: usize,
    /// Triangles of the finished world.
    triangles: u32,
    /// Cells in each line.
    lines: &'static [usize],
    /// Robots in the even and in the odd cells of a line.
    robots: [usize; 2],
    /// From line to line.
    pitch: f32,
    /// Racks one behind the other along x.
    rack_columns: usize,
}

const LARGE_PLAN: Plan = Plan {
    name: "factory-large",
    nodes: 3932,
    triangles: 184_000,
    lines: &[10, 8, 6, 4, 3, 2, 1],
    robots: [2, 1],
    pitch: 10.0,
    rack_columns: 3,
};

const MEDIUM_PLAN: Plan = Plan {
    name: "factory-medium",
    nodes: 1137,
    triangles: 52_000,
    lines: &[5, 3, 1],
    robots: [1, 2],
    pitch: 10.0,
    rack_columns: 2,
};

const SMALL_PLAN: Plan = Plan {
    name: "factory-small",
    nodes: 254,
    triangles: 167_000,
    lines: &[1],
    robots: [4, 4],
    pitch: 6.0,
    rack_columns: 1,
};

const MODEL_1_PLAN: Plan = Plan { name: "factory-model1", nodes: 3800, ..LARGE_PLAN };

const MODEL_2_PLAN: Plan = Plan { name: "factory-model2", nodes: 188, robots: [2, 2], ..SMALL_PLAN };

const MODEL_3_PLAN: Plan = Plan { name: "factory-model3", nodes: 1274, ..MEDIUM_PLAN };

/// 3932 nodes, 184,000 triangles, 149.5 x 80 m.
pub(super) const LARGE: Generator = Generator {
    name: LARGE_PLAN.name,
    about: "car factory, 3932 nodes, 184,000 triangles (stand-in: Paper II sec. 2, Paper I sec. 4)",
    generate: || layout::lay_out(&LARGE_PLAN),
    aisles: || LARGE_PLAN.aisles(),
};

/// 1137 nodes, 52,000 triangles, 89 x 40 m.
pub(super) const MEDIUM: Generator = Generator {
    name: MEDIUM_PLAN.name,
    about: "shop floor, 1137 nodes, 52,000 triangles (stand-in: Paper II sec. 2, Paper I sec. 4)",
    generate: || layout::lay_out(&MEDIUM_PLAN),
    aisles: || MEDIUM_PLAN.aisles(),
};

/// 254 nodes, 167,000 triangles, 38 x 12 m.
pub(super) const SMALL: Generator = Generator {
    name: SMALL_PLAN.name,
    about: "one cell, finely tessellated, 254 nodes, 167,000 triangles (stand-in, same sources)",
    generate: || layout::lay_out(&SMALL_PLAN),
    aisles: || SMALL_PLAN.aisles(),
};

/// 3800 nodes, 184,000 triangles.
pub(super) const MODEL_1: Generator = Generator {
    name: MODEL_1_PLAN.name,
    about: "Model 1 of Paper I sec. 4: car factory, 3800 nodes, 184,000 triangles (stand-in)",
    generate: || layout::lay_out(&MODEL_1_PLAN),
    aisles: || MODEL_1_PLAN.aisles(),
};

/// 188 nodes, 167,000 triangles.
pub(super) const MODEL_2: Generator = Generator {
    name: MODEL_2_PLAN.name,
    about: "Model 2 of Paper I sec. 4: one cell, 188 nodes, 167,000 triangles (stand-in)",
    generate: || layout::lay_out(&MODEL_2_PLAN),
    aisles: || MODEL_2_PLAN.aisles(),
};

/// 1274 nodes, 52,000 triangles.
pub(super) const MODEL_3: Generator = Generator {
    name: MODEL_3_PLAN.name,
    about: "Model 3 of Paper I sec. 4: shop floor, 1274 nodes, 52,000 triangles (stand-in)",
    generate: || layout::lay_out(&MODEL_3_PLAN),
    aisles: || MODEL_3_PLAN.aisles(),
};

/// Length of a cell along its line, in metres.
const CELL_LENGTH: f32 = 9.5;
/// Where the lines begin, in metres from the wall.
const LINE_START: f32 = 6.0;
/// From rack to rack along x, in metres.
const RACK_PITCH: f32 = 13.0;

impl Plan {
    /// The aisle between the lines and the store: its x, in metres.
    fn middle_aisle(&self) -> f32 {
        let longest = self.lines.iter().max().copied().unwrap_or(0);
        LINE_START + CELL_LENGTH * longest as f32 + 2.5
    }

    /// Where the store begins, in metres.
    fn store_start(&self) -> f32 {
        self.middle_aisle() + 2.5
    }

    /// The aisle behind the store: its x, in metres.
    fn last_aisle(&self) -> f32 {
        self.store_start() + RACK_PITCH * self.rack_columns as f32 + 2.0
    }

    /// Length (x) and width (z) of the hall, in metres.
    fn size(&self) -> (f32, f32) {
        (self.last_aisle() + 2.5, self.pitch * (self.lines.len() + 1) as f32)
    }

    /// Where a line runs: its z, in metres.
    fn line_z(&self, line: usize) -> f32 {
        self.pitch * (line + 1) as f32
    }

    fn aisles(&self) -> Aisles {
        let (length, width) = self.size();
        let far = (length + width).ceil();
        if self.lines == [1] {
            // A lone cell is walked right through, past its robots: "the small offers more immersive
            // navigation" (Paper II, caption of Fig. 1).
            let (start, z) = (LINE_START, self.line_z(0));
            let x = [0.1, 0.35, 0.6, 0.85].map(|share| start + share * CELL_LENGTH).to_vec();
            return Aisles { x, z: vec![z - 1.5, z, z + 1.5], far };
        }
        let z = (0..=self.lines.len()).map(|line| self.line_z(line) - self.pitch * 0.5).collect();
        Aisles { x: vec![3.0, self.middle_aisle(), self.last_aisle()], z, far }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Scene, describe};

    #[test]
    fn counts_are_exact_and_graphs_valid() {
        for plan in [LARGE_PLAN, MEDIUM_PLAN, SMALL_PLAN, MODEL_1_PLAN, MODEL_2_PLAN, MODEL_3_PLAN] {
            let scene: Scene = layout::lay_out(&plan);
            scene.validate().unwrap();
            let description = describe(&scene);
            assert_eq!(description.nodes, plan.nodes, "{}", plan.name);
            assert_eq!(description.instanced_triangles, plan.triangles as usize, "{}", plan.name);
            assert_eq!(description.zero_area, 0);
            assert!(description.depth >= 13 && description.widest_fan_out >= 8);
            assert!(scene.nodes.iter().all(|node| node.mesh.is_some() || !node.children.is_empty()));
            let (length, width) = plan.size();
            let bounds = scene.bounds();
            assert!(bounds.min.x >= -0.5 && bounds.max.x <= length + 0.5 && bounds.max.z <= width + 0.5);
        }
    }
}
