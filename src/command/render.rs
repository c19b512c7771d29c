//! `apportion render`: a picture of a scene.

use super::progress::Bar;
use super::words::RenderWords;
use super::{print, words};
use anyhow::{Context, Result};
use apportion::geometry::{Camera, Lens};
use apportion::job::trace::{
    Counts, Eye, Film, Frame, Hierarchy, Image, Look, Tracer, TriangleKind, World, default_view, light_at,
    view_within,
};
use apportion::machine::{Machine, Processor, Threads};
use apportion::measure::MeasureError;
use apportion::record::write_whole;
use apportion::scene::{Cache, Scene, SceneError, by_name};
use apportion::scheme::ShareError;
use apportion::scheme::tiles::{Scheme, TileWork};
use apportion::structure::bvh::build::{Builder, Settings};
use glam::Vec3;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Builds the hierarchy: what is traced once need not have the best.
const BUILDER: &str = "binned_sah";

/// Renders and writes the picture, and tells what it took.
pub(crate) fn render(words: &RenderWords) -> Result<()> {
    let out = words.out.clone().unwrap_or_else(|| beside_us(&words.scene));
    // Before anything is traced for nothing.
    let write = writer(&out)?;
    let team = Threads::new(words.processors.unwrap_or_else(cores) as usize)?;
    let processors = team.most_processors();
    let scheme = Scheme::new(&words.scheme, &team, processors, BTreeMap::new());
    let mut scheme = scheme.map_err(|error| MeasureError::Words(error.to_string()))?;
    let scene = read(&words.scene)?;
    scene.warnings.iter().for_each(|warning| print::note(warning));
    let (width, height) = words.size;
    let aspect = width as f32 / height as f32;
    let mut world = World::new(scene);
    let mut builder = Builder::new(BUILDER, &Settings::default())?;
    let hierarchy = Hierarchy::new(world.items(), &mut builder, TriangleKind::Watertight)?;
    let scene = world.scene();
    let within = || scene.view.is_none().then(|| view_within(&world, &hierarchy, aspect)).flatten();
    let camera = match &words.camera {
        Some(camera) => looking(camera, scene, aspect)?,
        None => within()
            .or_else(|| default_view(scene, aspect))
            .context("there is nothing to see in it; give --camera")?,
    };
    if scene.lights.is_empty() {
        let light = light_at(&camera, scene);
        world.add_light(light);
    }
    let unsaid = Look::default();
    let look = Look {
        depth: words.depth,
        ambient: world.scene().ambient.unwrap_or(unsaid.ambient),
        background: world.scene().background.unwrap_or(unsaid.background),
    };
    let mut film = Film::new(&team, width, height).context("the picture is too large")?;
    let before = team.now();
    let shares = {
        let tracer = Tracer::new(&world, &hierarchy, look);
        let frame = Frame::new(tracer, Eye::new(&camera, width, height), words.tile, &film);
        let bar = Bar::of_tiles(&world.scene().name, frame.tiles().count());
        let shares = scheme.run(&team, &Shown { frame: &frame, bar: &bar }).map_err(ShareError::from);
        bar.end();
        shares?
    };
    let seconds = (team.now() - before) as f64 / team.ticks_per_nanosecond() / 1e9;
    let mut counts = Counts::default();
    shares.into_iter().for_each(|share| counts += share.found);
    let image = film.image();
    write_whole(&out, |file| write(&image, file))?;
    print::line(&format!(
        "{}: {width} x {height}, {} rays ({} eye, {} shadow, {} reflection, {} refraction) in {seconds:.3} s, {:.2} M/s",
        out.display(),
        counts.rays(),
        counts.eye,
        counts.shadow,
        counts.reflection,
        counts.refraction,
        counts.rays() as f64 / seconds / 1e6,
    ))
}

fn cores() -> u32 {
    std::thread::available_parallelism().map_or(1, |cores| cores.get() as u32)
}

/// A file, or what a generator makes.
pub(super) fn read(name: &str) -> Result<Scene> {
    if name.contains(['.', '/', '\\']) {
        return Ok(Cache::of_user().load(name)?.0);
    }
    by_name(name).map_err(|error: SceneError| MeasureError::Words(error.to_string()).into())
}

/// The scene's name with `.png`, in the folder one is in.
fn beside_us(scene: &str) -> PathBuf {
    let name = Path::new(scene).file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = name.split('.').find(|part| !part.is_empty()).unwrap_or("scene").to_owned();
    PathBuf::from(stem + ".png")
}

type Writer = fn(&Image, &mut dyn Write) -> io::Result<()>;

/// What writes a file of this extension.
fn writer(out: &Path) -> Result<Writer, MeasureError> {
    const WRITERS: [(&str, Writer); 3] =
        [("png", Image::write_png), ("pfm", Image::write_pfm), ("exr", Image::write_exr)];
    let extension = out.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let found = WRITERS.iter().find(|(known, _)| *known == extension);
    found.map(|(_, writer)| *writer).ok_or_else(|| {
        MeasureError::Words(format!("{}: expected a name that ends in .png, .pfm or .exr", out.display()))
    })
}

/// The camera of the words, its planes such that the scene lies between them.
fn looking(words: &words::CameraWords, scene: &Scene, aspect: f32) -> Result<Camera, MeasureError> {
    let [eye, look] = [words.eye, words.look].map(Vec3::from);
    let bounds = scene.bounds();
    let far = eye.distance(bounds.centre()) + 1.1 * bounds.half_diagonal();
    let far = if far.is_finite() && far > 0.0 { far } else { 1.0 };
    let lens = Lens::Symmetric { fov_y: words.degrees.to_radians(), aspect };
    Camera::look_at(eye, look, Vec3::Y, lens, far * 1e-4, far)
        .map_err(|error| MeasureError::Words(format!("--camera: {error}")))
}

/// A picture whose finished tiles are shown.
struct Shown<'a, W> {
    frame: &'a W,
    bar: &'a Bar,
}

impl<W: TileWork> TileWork for Shown<'_, W> {
    type Found = W::Found;

    fn pieces(&self) -> usize {
        self.frame.pieces()
    }

    fn found(&self) -> W::Found {
        self.frame.found()
    }

    fn work_on<P: Processor>(&self, pieces: Range<usize>, found: &mut W::Found, cpu: &P) {
        for piece in pieces {
            self.frame.work_on(piece..piece + 1, found, cpu);
            self.bar.more();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_called_after_their_scene() {
        for (scene, name) in [("a/b.c/sponza.obj", "sponza.png"), ("room", "room.png"), ("x.ply.gz", "x.png")]
        {
            assert_eq!(beside_us(scene), PathBuf::from(name));
        }
        assert_eq!(beside_us(".."), PathBuf::from("scene.png"));
    }

    #[test]
    fn the_file_says_the_format() {
        for name in ["a.png", "a.PFM", "b.c/a.exr"] {
            assert!(writer(Path::new(name)).is_ok(), "{name}");
        }
        let error = writer(Path::new("a.gif")).unwrap_err();
        assert!(error.is_usage() && error.to_string().contains(".png"), "{error}");
    }
}
