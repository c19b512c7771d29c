//! Where everything stands in a factory. x runs along the lines, y up, z across; metres.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{Affine3A, Vec3};

use super::super::super::{Scene, SplitMix64};
use super::super::place::{turned_x, turned_y};
use super::parts::{Parts, Shape};
use super::{CELL_LENGTH, LINE_START, Plan, RACK_PITCH};

/// A factory in the making.
struct Site<'a> {
    plan: &'a Plan,
    scene: Scene,
    parts: Parts,
    random: SplitMix64,
}

/// Builds the factory of a plan.
pub(super) fn lay_out(plan: &Plan) -> Scene {
    let scene = Scene::new(plan.name);
    // The seed is the node count, so that no two factories pose their robots alike.
    let random = SplitMix64::new(plan.nodes as u64);
    let mut site = Site { plan, scene, parts: Parts::default(), random };
    let root = site.scene.add_node(None, plan.name, Affine3A::IDENTITY, None);
    site.hall(root);
    for (line, cells) in plan.lines.iter().enumerate() {
        site.line(root, line, *cells);
    }
    site.store(root);
    site.parts.finish(&mut site.scene, plan.triangles);
    site.scene
}

impl Site<'_> {
    fn group(&mut self, parent: u32, name: &str, place: Vec3) -> u32 {
        self.scene.add_node(Some(parent), name, Affine3A::from_translation(place), None)
    }

    fn part(&mut self, parent: u32, name: &'static str, shape: Shape, place: Affine3A) -> u32 {
        let node = self.scene.add_node(Some(parent), name, place, None);
        self.parts.place(node, name, shape);
        node
    }

    fn part_at(&mut self, parent: u32, name: &'static str, shape: Shape, place: Vec3) -> u32 {
        self.part(parent, name, shape, Affine3A::from_translation(place))
    }

    fn hall(&mut self, root: u32) {
        let (length, width) = self.plan.size();
        let hall = self.group(root, "hall", Vec3::ZERO);
        let floor = Vec3::new(length, 0.2, width);
        self.part_at(hall, "floor", Shape::Box(floor), Vec3::new(length * 0.5, -0.2, width * 0.5));
        for z in [0.0, width] {
            let wall = Shape::Box(Vec3::new(length, 8.0, 0.3));
            self.part_at(hall, "long wall", wall, Vec3::new(length * 0.5, 0.0, z));
        }
        for x in [0.0, length] {
            let wall = Shape::Box(Vec3::new(0.3, 8.0, width));
            self.part_at(hall, "short wall", wall, Vec3::new(x, 0.0, width * 0.5));
        }
        let columns = self.group(hall, "columns", Vec3::ZERO);
        for line in 0..self.plan.lines.len() {
            // Beside the aisle, not in it.
            let z = self.plan.line_z(line) - self.plan.pitch * 0.5 + 1.3;
            for x in (1..).map(|i| 15.0 * i as f32).take_while(|x| *x < length - 5.0) {
                self.part_at(columns, "column", Shape::Round(0.25, 8.0), Vec3::new(x, 0.0, z));
            }
        }
    }

    fn line(&mut self, root: u32, number: usize, cells: usize) {
        let place = Vec3::new(LINE_START, 0.0, self.plan.line_z(number));
        let line = self.group(root, &format!("line {number}"), place);
        // One frame a cell long is stretched over the line, so that all lines share its mesh.
        let stretch = Vec3::new(cells as f32, 1.0, 1.0);
        let length = CELL_LENGTH * cells as f32;
        let conveyor = self.group(line, "conveyor", Vec3::ZERO);
        let frame =
            Affine3A::from_translation(Vec3::new(length * 0.5, 0.4, 0.0)) * Affine3A::from_scale(stretch);
        self.part(conveyor, "conveyor frame", Shape::Box(Vec3::new(CELL_LENGTH, 0.3, 0.9)), frame);
        for roller in 0..cells * 10 {
            let place = Vec3::new(0.95 * roller as f32 + 0.45, 0.78, -0.4);
            self.part(conveyor, "roller", Shape::Round(0.08, 0.8), turned_x(place, FRAC_PI_2));
        }
        for cell in 0..cells {
            let place = Vec3::new(CELL_LENGTH * (cell as f32 + 0.5), 0.0, 0.0);
            self.cell(line, cell, place);
        }
    }

    fn cell(&mut self, line: u32, number: usize, place: Vec3) {
        let cell = self.group(line, &format!("cell {number}"), place);
        let edge = self.plan.pitch * 0.32;
        let fence = self.group(cell, "fence", Vec3::ZERO);
        for (side, panel) in (0..8).map(|i| (i / 4, i % 4)) {
            let place = Vec3::new(2.2 * panel as f32 - 3.3, 0.0, if side == 0 { -edge } else { edge });
            self.part_at(fence, "fence panel", Shape::Box(Vec3::new(2.1, 1.8, 0.05)), place);
        }
        let cabinet = Shape::Box(Vec3::new(0.8, 1.9, 0.4));
        self.part_at(cell, "cabinet", cabinet, Vec3::new(4.2, 0.0, edge - 0.4));
        let fixture = self.group(cell, "fixture", Vec3::new(0.0, 0.9, 0.0));
        let table = Shape::Box(Vec3::new(2.4, 0.1, 0.8));
        self.part_at(fixture, "fixture table", table, Vec3::ZERO);
        for piece in 0..4 {
            let place = Vec3::new(0.55 * piece as f32 - 0.8, 0.1, self.random.between(-0.2, 0.2) as f32);
            self.part_at(fixture, "workpiece", Shape::Fine(0.15, 0.3), place);
        }
        for robot in 0..self.plan.robots[number % 2] {
            let side = if robot % 2 == 0 { 1.0 } else { -1.0 };
            let along = if robot < 2 { -1.5 } else { 1.5 };
            self.robot(cell, Vec3::new(along, 0.0, 1.6 * side), if robot % 2 == 0 { PI } else { 0.0 });
        }
    }

    /// A robot of six joints, facing the conveyor when `facing` turns +z there: pedestal, base, six
    /// links one on the other, each with a motor and a cover, a tool, its fingers and a camera.
    fn robot(&mut self, cell: u32, place: Vec3, facing: f64) {
        let pedestal = Shape::Box(Vec3::new(0.7, 0.25, 0.7));
        let robot = self.part(cell, "robot pedestal", pedestal, turned_y(place, facing));
        let swing = self.random.between(-0.8, 0.8);
        let place = turned_y(Vec3::Y * 0.25, swing);
        let mut above = self.part(robot, "robot base", Shape::Fine(0.28, 0.45), place);
        let mut height = 0.45;
        // Name, radius, length and bend at rest of each link.
        let links = [
            ("link 1", 0.20, 0.30, 0.0),
            ("link 2", 0.14, 0.75, 0.5),
            ("link 3", 0.12, 0.25, 0.7),
            ("link 4", 0.10, 0.60, 0.5),
            ("link 5", 0.08, 0.20, 0.6),
            ("link 6", 0.06, 0.12, 0.0),
        ];
        for (name, radius, length, bend) in links {
            let angle = bend + self.random.between(-0.25, 0.25);
            above = self.part(above, name, Shape::Fine(radius, length), turned_x(Vec3::Y * height, angle));
            let motor = turned_x(Vec3::new(radius, 0.0, 0.0), FRAC_PI_2);
            self.part(above, "motor", Shape::Fine(0.06, 0.12), motor);
            let cover = Vec3::new(0.0, length * 0.4, -radius);
            self.part_at(above, "cover", Shape::Box(Vec3::new(0.1, 0.1, 0.04)), cover);
            height = length;
        }
        let tool = self.part_at(above, "tool", Shape::Fine(0.05, 0.10), Vec3::Y * height);
        for side in [-0.04, 0.04] {
            let finger = Shape::Box(Vec3::new(0.02, 0.12, 0.03));
            self.part_at(tool, "finger", finger, Vec3::new(side, 0.10, 0.0));
        }
        self.part_at(tool, "camera", Shape::Box(Vec3::splat(0.05)), Vec3::new(0.0, 0.02, 0.07));
    }

    /// Racks of four boards with 24 bins each, rack after rack until the nodes are used up.
    fn store(&mut self, root: u32) {
        let start = self.plan.store_start() + RACK_PITCH * 0.5;
        let store = self.group(root, "store", Vec3::ZERO);
        let rows = self.plan.lines.len() * 3;
        for (row, column) in (0..rows * self.plan.rack_columns).map(|rack| (rack % rows, rack / rows)) {
            // Three rows of racks between one aisle and the next.
            let within = [-0.28, 0.0, 0.28][row % 3] * self.plan.pitch;
            let place =
                Vec3::new(start + RACK_PITCH * column as f32, 0.0, self.plan.line_z(row / 3) + within);
            if self.is_full() {
                return;
            }
            let frame = Shape::Box(Vec3::new(12.2, 0.1, 0.7));
            let rack = self.part_at(store, "rack", frame, place);
            for level in 0..4 {
                if self.is_full() {
                    return;
                }
                let board = Shape::Box(Vec3::new(12.0, 0.04, 0.6));
                let shelf = self.part_at(rack, "shelf", board, Vec3::Y * (0.3 + 0.6 * level as f32));
                for bin in 0..24 {
                    if self.is_full() {
                        return;
                    }
                    let depth = self.random.between(-0.05, 0.05) as f32;
                    let place = Vec3::new(0.5 * bin as f32 - 5.75, 0.04, depth);
                    self.part_at(shelf, "bin", Shape::Box(Vec3::new(0.4, 0.3, 0.5)), place);
                }
            }
        }
        assert!(self.is_full(), "the store of {} is too small", self.plan.name);
    }

    fn is_full(&self) -> bool {
        self.scene.nodes.len() == self.plan.nodes
    }
}
