//! `apportion render`: a picture of a scene, or many of one that moves.

mod video;
mod words;

pub(crate) use words::{RENDER_EXAMPLES, RenderWords};

use super::print;
use super::progress::Bar;
use anyhow::{Context, Result};
use apportion::geometry::{Camera, Lens};
use apportion::job::trace::{
    Counts, Eye, Film, Frame, Hierarchy, Image, Look, Tiles, Tracer, TriangleKind, World, default_view,
    light_at, view_within,
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
use words::CameraWords;

/// Builds the hierarchy: what is traced once need not have the best.
const BUILDER: &str = "binned_sah";

/// Renders and writes what the words ask for, and tells what it took.
pub(crate) fn render(words: &RenderWords) -> Result<()> {
    match words.frames {
        Some(frames) => video::video(words, frames),
        None => picture(words),
    }
}

fn picture(words: &RenderWords) -> Result<()> {
    let out = words.out.clone().unwrap_or_else(|| PathBuf::from(stem(&words.scene) + ".png"));
    // Before anything is traced for nothing.
    let write = writer(&out)?;
    let (team, mut scheme) = checked(words)?;
    let scene = at_frame(read(&words.scene)?, words.frame)?;
    scene.warnings.iter().for_each(|warning| print::note(warning));
    let (width, height) = words.size;
    let aspect = width as f32 / height as f32;
    let items = World::count(&scene);
    anyhow::ensure!(u32::try_from(items).is_ok(), "{items} triangles and spheres are more than 2^32 - 1");
    let mut world = World::new(scene);
    let mut builder = Builder::new(BUILDER, &Settings::default())?;
    let hierarchy = Hierarchy::of(&world, words.levels, &mut builder, TriangleKind::Watertight)?;
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
    let look = Look { depth: words.depth, ..Look::of(world.scene()) };
    let mut film = Film::new(&team, width, height).context("the picture is too large")?;
    let bar = Bar::of_tiles(&world.scene().name, Tiles::new(words.size, words.tile).count());
    let before = team.now();
    let tracer = Tracer::new(&world, &hierarchy, look);
    let eye = Eye::new(&camera, width, height);
    let traced = trace(&team, &mut scheme, tracer, eye, words.tile, &mut film, &bar);
    let seconds = (team.now() - before) as f64 / team.ticks_per_nanosecond() / 1e9;
    bar.end();
    let counts = traced?;
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

/// The team of the words, and the scheme that shares tiles out among it.
fn checked(words: &RenderWords) -> Result<(Threads, Scheme<Threads>)> {
    let team = Threads::new(words.processors.unwrap_or_else(cores) as usize)?;
    let scheme = Scheme::new(&words.scheme, &team, team.most_processors(), BTreeMap::new());
    Ok((team, scheme.map_err(|error| MeasureError::Words(error.to_string()))?))
}

/// Traces a picture onto the film, showing how far it is.
fn trace(
    team: &Threads,
    scheme: &mut Scheme<Threads>,
    tracer: Tracer<'_>,
    eye: Eye,
    tile: (u32, u32),
    film: &mut Film<Threads>,
    bar: &Bar,
) -> Result<Counts> {
    let frame = Frame::new(tracer, eye, tile, film);
    let shares = scheme.run(team, &Shown { frame: &frame, bar }).map_err(ShareError::from)?;
    let mut counts = Counts::default();
    shares.into_iter().for_each(|share| counts += share.found);
    Ok(counts)
}

/// How many frames a scene has of its own; one that does not move has no other than the first.
fn frames_of(scene: &Scene) -> u32 {
    if scene.animation.is_still() { 1 } else { scene.animation.frames.max(1) }
}

/// A scene that moves as it is in a frame of its own.
fn at_frame(scene: Scene, frame: u32) -> Result<Scene, MeasureError> {
    let (animation, frames) = (&scene.animation, frames_of(&scene));
    let time = animation.times(frames).nth(frame as usize).ok_or_else(|| {
        MeasureError::Words(format!(
            "--frame {frame}: expected one from 0 to {}, as the scene has them",
            frames - 1
        ))
    })?;
    Ok(if animation.is_still() { scene } else { scene.still(time) })
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

/// What pictures are called after: the scene's name, or its file's without what follows the first point.
fn stem(scene: &str) -> String {
    let name = Path::new(scene).file_name().unwrap_or_default().to_string_lossy().into_owned();
    name.split('.').find(|part| !part.is_empty()).unwrap_or("scene").to_owned()
}

type Writer = fn(&Image, &mut dyn Write) -> io::Result<()>;

/// What writes a file of this extension.
fn writer(out: &Path) -> Result<Writer, MeasureError> {
    const WRITERS: [(&str, Writer); 3] =
        [("png", Image::write_png), ("pfm", Image::write_pfm), ("exr", Image::write_exr)];
    let extension = out.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let found = WRITERS.iter().find(|(known, _)| *known == extension);
    found.map(|(_, writer)| *writer).ok_or_else(|| {
        let film = if extension == "y4m" { "; a film takes --frames, such as --frames .." } else { "" };
        let out = out.display();
        MeasureError::Words(format!("{out}: expected a name that ends in .png, .pfm or .exr{film}"))
    })
}

/// The camera of the words, its planes such that the scene lies between them.
fn looking(words: &CameraWords, scene: &Scene, aspect: f32) -> Result<Camera, MeasureError> {
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
        for (scene, name) in [("a/b.c/sponza.obj", "sponza"), ("room", "room"), ("x.ply.gz", "x")] {
            assert_eq!(stem(scene), name);
        }
        assert_eq!(stem(".."), "scene");
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
