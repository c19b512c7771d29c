//! What the commands `scene` and `machine` show.

use super::subject::read_scene;
use super::{MeasureError, near};
use crate::machine::Threads;
use crate::machine::simulated::Model;
use crate::record::THREADS;
use crate::scene::describe;
use crate::structure::{AabbTree, SkipTree, TreeStatistics};
use std::fmt::Write;

/// What a scene holds, in lines for a reader.
///
/// # Errors
/// The scene cannot be had.
pub fn scene(name: &str) -> Result<String, MeasureError> {
    let (scene, origin) = read_scene(name)?;
    let holds = describe(&scene);
    let tree = SkipTree::build(&AabbTree::build(&scene));
    let shape = TreeStatistics::of(&tree);
    let mut text = String::new();
    let mut line = |what: &str, value: String| {
        writeln!(text, "{what:22} {value}").expect("a string takes all");
    };
    line("scene", holds.name);
    if let Some(origin) = origin {
        line("read from", origin.to_string());
    }
    line(
        "graph",
        format!(
            "{} nodes, depth {}, widest fan-out {}, mean {:.1}",
            holds.nodes, holds.depth, holds.widest_fan_out, holds.mean_fan_out
        ),
    );
    line("nodes by depth", numbers(&holds.depths));
    line("meshes", format!("{}, {} triangles", holds.meshes, holds.unique_triangles));
    line("placed", format!("{} times, {} triangles", holds.instances, holds.instanced_triangles));
    if holds.primitives > 0 {
        line("spheres and cones", holds.primitives.to_string());
    }
    line(
        "seen with",
        format!("{} materials, {} textures, {} lights", holds.materials, holds.textures, holds.lights),
    );
    if !scene.animation.is_still() {
        line(
            "moves",
            format!(
                "{} nodes and {} meshes of {} triangles, {:.1} s in {} frames",
                holds.moving, holds.bending, holds.bending_triangles, holds.seconds, holds.frames
            ),
        );
    }
    scene.warnings.iter().for_each(|warning| line("warning", warning.clone()));
    match (holds.bounds_min, holds.bounds_max) {
        (Some(min), Some(max)) => line("bounds", format!("{min:?} to {max:?}")),
        _ => line("bounds", "none: there is nothing to see".to_owned()),
    }
    line("memory", format!("{} bytes, its box tree {} more", holds.bytes, shape.bytes));
    line(
        "how skinny",
        format!(
            "triangle aspect {:.1} median, {:.1} for 90 %, {:.1} for 99 %; {} without area",
            holds.aspect_p50, holds.aspect_p90, holds.aspect_p99, holds.zero_area
        ),
    );
    line("box tree", format!("{} nodes, {} leaves, depth {}", shape.nodes, shape.leaves, shape.depth));
    line("leaves by depth", numbers(&shape.leaf_depths));
    line(
        "how unbalanced",
        format!(
            "the heaviest child holds {:.0} % of what is below a node on average, {:.0} % at most",
            100.0 * shape.mean_heaviest_share,
            100.0 * shape.max_heaviest_share
        ),
    );
    Ok(text.trim_end().to_owned())
}

fn numbers(counts: &[usize]) -> String {
    counts.iter().map(usize::to_string).collect::<Vec<_>>().join(" ")
}

/// Interleaved repeats, and runs back to back in each, of `machine predict`.
const PREDICT: (usize, usize) = (15, 20);

/// The constants of a machine, or one line on each of them, for a reader. `calibrate` fits `host` to this
/// computer and prints it as a file for `--machine FILE.toml`; `predict` fits it too and holds the speedups
/// it foretells against measured ones. `progress` is told what is being measured.
///
/// # Errors
/// There is no such machine, or the fit failed.
pub fn machine(name: Option<&str>, progress: &mut (dyn FnMut(&str) + Send)) -> Result<String, MeasureError> {
    let failed = |error: &dyn std::fmt::Display| MeasureError::Failed(error.to_string());
    match name {
        Some("calibrate") => {
            let calibration = super::calibrate::calibrate(progress).map_err(|e| failed(&e))?;
            Ok(calibration.to_toml().trim_end().to_owned())
        }
        Some("predict") => {
            let (repeats, runs) = PREDICT;
            Ok(super::calibrate::predict(repeats, runs, progress).map_err(|e| failed(&e))?.to_string())
        }
        Some(THREADS) => Ok(format!("{THREADS:12} {}", this_computer())),
        Some(name) => {
            let unknown = |_| {
                let known = Model::names().chain([THREADS, "calibrate", "predict"]);
                MeasureError::Unknown { kind: "machine", name: name.to_owned(), near: near(name, known) }
            };
            let is_file = name.ends_with(".toml");
            let model = Model::named(name).map_err(|e| if is_file { failed(&e) } else { unknown(e) })?;
            Ok(toml::to_string(&model).map_err(|e| failed(&e))?.trim_end().to_owned())
        }
        None => {
            let mut lines = vec![format!("{THREADS:12} {}", this_computer())];
            for name in Model::names() {
                let model = Model::named(name).map_err(|e| failed(&e))?;
                lines.push(format!("{name:12} {}", model.description));
            }
            Ok(lines.join("\n"))
        }
    }
}

fn this_computer() -> String {
    format!("real threads of this computer: {} cores", Threads::cores())
}
