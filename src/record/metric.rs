//! The list of metrics: each is declared here, once, with its name, its unit and a sentence.

/// Which way a metric is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// More is better: a speedup.
    Higher,
    /// Less is better: a time.
    Lower,
}

/// What a number says a method gave up for its speed; never two kinds on one axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccuracyKind {
    /// The result itself is another: missed hits, a coarser picture.
    Answer,
    /// The same result, for more work: boxes called intersecting that are not, tests a ray.
    Structure,
    /// An older result: age in frames.
    Timeliness,
}

impl AccuracyKind {
    /// The kinds, in the order they are shown.
    pub const ALL: [Self; 3] = [Self::Answer, Self::Structure, Self::Timeliness];

    /// The kind in a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Answer => "answer",
            Self::Structure => "structure",
            Self::Timeliness => "timeliness",
        }
    }
}

/// A metric: what a row's number means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Metric {
    /// The word in the column `metric`.
    pub name: &'static str,
    /// The word in the column `unit`.
    pub unit: &'static str,
    /// Which way is better.
    pub better: Better,
    /// What it is, in a sentence.
    pub sentence: &'static str,
    /// What it says was given up for speed; none where it is no measure of that.
    pub accuracy: Option<AccuracyKind>,
    /// It counts by how much the answer is larger than it need be: answers of any size can be compared by it.
    pub counts_surplus: bool,
}

/// The metric of that name.
pub fn metric(name: &str) -> Option<&'static Metric> {
    METRICS.iter().find(|metric| metric.name == name)
}

const fn declare(name: &'static str, unit: &'static str, better: Better, sentence: &'static str) -> Metric {
    Metric { name, unit, better, sentence, accuracy: None, counts_surplus: false }
}

impl Metric {
    /// The same metric, as one that says what was given up for speed.
    const fn gives_up(self, kind: AccuracyKind) -> Self {
        Self { accuracy: Some(kind), ..self }
    }

    /// The same metric, as one that counts what an answer holds too much, which costs work later on.
    const fn surplus(self) -> Self {
        Self { counts_surplus: true, ..self.gives_up(AccuracyKind::Structure) }
    }
}

/// Every metric there is.
pub const METRICS: &[Metric] = {
    use Better::{Higher, Lower};
    &[
        declare(
            "frame_time",
            "ns",
            Lower,
            "Time from giving a frame to the scheme to its last processor done.",
        ),
        declare("frame_time_p50", "ns", Lower, "Half of the cell's frames took no longer."),
        declare("frame_time_p90", "ns", Lower, "Nine tenths of the cell's frames took no longer."),
        declare("frame_time_p99", "ns", Lower, "99 in 100 of the cell's frames took no longer."),
        declare("frame_time_max", "ns", Lower, "The cell's slowest frame."),
        declare("total_time", "ns", Lower, "The sum of the cell's frame times."),
        declare("speedup", "x", Higher, "Serial total time over this cell's, both of the same repeat."),
        declare(
            "speedup_self",
            "x",
            Higher,
            "The scheme's own total time on one processor over this cell's, both of the same repeat.",
        ),
        declare(
            "load_imbalance",
            "%",
            Lower,
            "How much longer the busiest processor worked than the mean of all, as a share of the mean.",
        ),
        declare(
            "traversal_share",
            "%",
            Lower,
            "Share of the processors' time that went into finding and handing over work, not into the work itself.",
        ),
        declare(
            "processors_used",
            "processors",
            Lower,
            "Processors that took part in a frame, on average: a scheme may leave some out.",
        ),
        declare("nodes_visited", "nodes", Lower, "Nodes of the structure the job looked at.")
            .gives_up(AccuracyKind::Structure),
        declare("time_per_visit", "ns", Lower, "Total time over all nodes looked at."),
        declare(
            "speedup_over_baseline",
            "x",
            Higher,
            "Time of the baseline's test over this cell's, serial, frames taken in turn.",
        ),
        declare(
            "falsely_intersecting",
            "volumes",
            Lower,
            "Volumes a frame that were called intersecting, but are outside by the exact test.",
        )
        .surplus(),
        declare(
            "falsely_inside",
            "volumes",
            Lower,
            "Volumes a frame that were called inside, but cross the frustum by the exact test.",
        )
        .surplus(),
        declare(
            "overdrawn_nodes",
            "nodes",
            Lower,
            "Nodes drawn a frame though none of their triangles meets the frustum.",
        )
        .surplus(),
        declare("overdrawn_triangles", "triangles", Lower, "Triangles of such nodes.").surplus(),
        declare(
            "overdrawn_angle",
            "%",
            Lower,
            "Solid angle that the boxes of such nodes take up, summed over a frame, in per cent of the view's own.",
        )
        .surplus(),
        declare("nodes_visible", "nodes", Higher, "Leaf nodes found visible."),
        declare("traversal_time", "ns", Lower, "Time a frame of finding what to draw, without drawing it."),
        declare(
            "draw_time",
            "ns",
            Lower,
            "Time a frame of drawing what was found, by software, on one processor.",
        ),
        declare("draw_calls", "calls", Lower, "Leaves drawn a frame, each with a call of its own."),
        declare("vertices_transformed", "vertices", Lower, "Vertices brought before the lens a frame."),
        declare("triangles_drawn", "triangles", Lower, "Triangles a frame of the leaves drawn."),
        declare(
            "triangles_outside",
            "triangles",
            Lower,
            "Triangles drawn a frame that lie wholly outside the view: what finer leaves would have spared.",
        )
        .gives_up(AccuracyKind::Structure),
        declare("triangles_set_up", "triangles", Lower, "Triangles, or pieces of cut ones, set up a frame."),
        declare("pixel_tests", "pixels", Lower, "Pixels held against the depth buffer a frame."),
        declare("pixels_passed", "pixels", Lower, "Pixel tests a frame that found something nearer."),
        declare("pixels_covered", "pixels", Higher, "Pixels of a finished frame that show something."),
        declare("leaves", "leaves", Lower, "Leaves of all copies of all meshes: the objects of the tree."),
        declare("split_time", "ns", Lower, "Time of splitting the scene's meshes and placing their leaves."),
        declare("split_rate", "Mtriangles/s", Higher, "Millions of triangles of meshes split a second."),
        declare("split_medians", "cuts", Lower, "Cuts of a mesh that had to be made at the median."),
        declare("split_depth", "parts", Lower, "Parts on the longest way from a whole mesh to a leaf."),
        declare("build_time", "ns", Lower, "Time of building the tree over the leaves."),
        declare("build_rate", "Mleaves/s", Higher, "Millions of leaves built into the tree a second."),
        declare(
            "refit_time",
            "ns",
            Lower,
            "Time a frame of bringing the tree up to date with what moved: transforms, volumes, forgetting.",
        ),
        declare(
            "nodes_refitted",
            "nodes",
            Lower,
            "Nodes a frame whose volumes changed, so that what was kept of them is forgotten.",
        ),
        declare("boxes_visible", "boxes", Lower, "Boxes not found to be outside."),
        declare("time_per_box", "ns", Lower, "The median frame's time over the boxes there are."),
        declare("bytes_per_second", "B/s", Higher, "Bytes of all boxes over the median frame's time."),
        declare("stream_time", "ns", Lower, "Median time to read the boxes' memory, shared out alike."),
        declare(
            "stream_ratio",
            "x",
            Lower,
            "The median frame's time over that of reading the boxes' memory.",
        ),
        declare("box_tests", "tests", Lower, "Overlap tests of boxes a frame.")
            .gives_up(AccuracyKind::Structure),
        declare("triangle_tests", "tests", Lower, "Pairs of triangles a frame that were tested exactly.")
            .gives_up(AccuracyKind::Structure),
        declare(
            "false_overlaps",
            "pairs",
            Lower,
            "Pairs of leaves a frame that overlapped though none of their triangles touch.",
        )
        .surplus(),
        declare("contacts", "pairs", Higher, "Pairs of triangles, or of scene nodes, a frame that touch."),
        declare("time_per_test", "ns", Lower, "Total time over all overlap tests of boxes."),
        declare(
            "tree_rate",
            "Mtriangles/s",
            Higher,
            "Millions of triangles of both bodies built into volume trees a second, on one thread.",
        ),
        declare(
            "tightness",
            "x",
            Lower,
            "Surface of all volumes of both bodies over that of the aligned boxes in their place.",
        ),
        declare("rays", "rays", Lower, "Rays traced a frame, or a pass, of all classes."),
        declare("rays_eye", "rays", Lower, "Rays a frame from the eye."),
        declare("rays_shadow", "rays", Lower, "Rays a frame from a surface to a light."),
        declare("rays_reflection", "rays", Lower, "Mirrored rays a frame."),
        declare("rays_refraction", "rays", Lower, "Rays a frame that were let through a surface."),
        declare("ray_rate", "Mrays/s", Higher, "Millions of rays of all classes a second."),
        declare("rays_hit", "%", Higher, "Share of the rays that meet something."),
        declare(
            "rays_through",
            "rays",
            Lower,
            "Rays aimed at the corners and edges of a closed shape's triangles, from within, that meet nothing.",
        )
        .gives_up(AccuracyKind::Answer),
        declare("nodes_per_ray", "nodes", Lower, "Nodes of eight boxes a ray was tested against.")
            .gives_up(AccuracyKind::Structure),
        declare("blocks_per_ray", "blocks", Lower, "Blocks of up to four triangles a ray was tested against.")
            .gives_up(AccuracyKind::Structure),
        declare("sah_cost", "steps", Lower, "What a ray costs by the surface area heuristic, a step or a test being 1.")
            .gives_up(AccuracyKind::Structure),
        declare("structure_time", "ns", Lower, "Median time of building the binary hierarchy over the triangles."),
        declare("structure_rate", "Mtriangles/s", Higher, "Millions of triangles built into it a second."),
        declare("refit_rate", "Mtriangles/s", Higher, "Millions of triangles a second whose hierarchy was given new boxes."),
        declare("collapse_time", "ns", Lower, "Median time of making the wide hierarchy of the binary one."),
        declare(
            "hierarchy_time",
            "ns",
            Lower,
            "Time of making all hierarchies that rays of pictures go through, from the scene on, once a cell.",
        ),
        declare("structure_bytes", "B", Lower, "Memory of the hierarchies that rays go through."),
        declare("frame_time_mean", "ns", Lower, "The mean of the cell's frame times."),
        declare(
            "deviation",
            "x",
            Lower,
            "Standard deviation of the cell's frame times over their mean (Lext et al. 2000, eq. 1 and 2).",
        ),
        declare(
            "continuity",
            "x",
            Lower,
            "The greatest change of the frame time from one frame to the next, over the mean (Lext et al. 2000, eq. 3).",
        ),
        declare(
            "update_time",
            "ns",
            Lower,
            "Mean time of a frame in which the scene takes its pose and the structure over it is brought up to date.",
        ),
        declare("rebuilt", "%", Lower, "Share of the frames for which the structure was made anew."),
        declare("preprocessing_time", "ns", Lower, "Time from the loaded scene to what its first frame starts from."),
        declare("primitives", "primitives", Lower, "What rays can meet: triangles, spheres and cones of the scene as it stands."),
        declare(
            "visibility_time",
            "ns",
            Lower,
            "Time of a frame in which it was asked what rays meet, of a pass apart from the one whose frames are timed, on one processor, clock reads in it (Lext et al. 2000, Measurement report proposal).",
        ),
        declare("shading_time", "ns", Lower, "Time of a frame of the same pass in which it was traced, but for that."),
        declare(
            "rebuild_time",
            "ns",
            Lower,
            "Time of a frame of the same pass in which the scene took its pose and the structure over it was brought up to date.",
        ),
        declare(
            "clock_time",
            "ns",
            Lower,
            "Time a frame of the same pass that reading the clock takes, as often as it was read: about half of it lies in the visibility time, half in the shading time.",
        ),
        declare("scene_bytes", "B", Lower, "Memory of the scene: meshes, materials, textures, key frames."),
        declare(
            "apnsr",
            "dB",
            Higher,
            "Peak noise to signal ratio of the mean of all frames' mean square errors, colours coded in 8 bits; of frames without any error, a value above that of the least there can be (Lext et al. 2000, eq. 4 to 6).",
        )
        .gives_up(AccuracyKind::Answer),
        declare("pnsr", "dB", Higher, "The same ratio of one frame."),
        declare(
            "ssim",
            "x",
            Higher,
            "Structural similarity of all frames to the exact ones, on average: 1 for the same (Wang et al. 2004).",
        )
        .gives_up(AccuracyKind::Answer),
        declare("pixels_other", "%", Lower, "Share of the pixels of all frames that are not those of the exact picture."),
        declare(
            "mover_x",
            "m",
            Lower,
            "Where the moving body was put, along x: where its origin is in the other's space. Told once a cell, of the first frame and of each in which it changed, as are the next five.",
        ),
        declare("mover_y", "m", Lower, "The same along y."),
        declare("mover_z", "m", Lower, "The same along z."),
        declare(
            "mover_turn_x",
            "rad",
            Lower,
            "How the moving body was turned about its origin: the angle times what the axis has along x.",
        ),
        declare("mover_turn_y", "rad", Lower, "The same along y."),
        declare("mover_turn_z", "rad", Lower, "The same along z."),
        declare(
            "lost_time",
            "%",
            Lower,
            "Share of one core that other work took away, seen by spinning on the clock just before the cell.",
        ),
        declare(
            "cell_complete",
            "rows",
            Higher,
            "The cell's last row: how many rows it has before this one.",
        ),
    ]
};
