//! `apportion render --frames`: a film of a scene that moves, or a picture of each of its frames.

use super::words::{FrameWords, RenderWords};
use super::{BUILDER, Writer, checked, frames_of, looking, read, stem, trace, writer};
use crate::command::print;
use crate::command::progress::Bar;
use anyhow::{Context, Result};
use apportion::job::animate::Moving;
use apportion::job::trace::{
    Counts, Eye, Film, FrameRate, Image, Look, Tiles, Tracer, TriangleKind, Video, World, default_view,
    light_at, view_within,
};
use apportion::machine::{Machine, Threads};
use apportion::measure::MeasureError;
use apportion::record::write_whole;
use apportion::scene::{PointLight, Scene};
use apportion::scheme::{frames, tiles};
use apportion::structure::bvh::build::{Builder, Settings};
use std::collections::BTreeMap;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::{Path, PathBuf};

/// Keeps the hierarchy up: made anew only where going on with it would cost more.
const UPKEEP: &str = "rebuild_on_threshold";

/// Renders the frames, writes them, and tells what it took.
pub(super) fn video(words: &RenderWords, frames: FrameWords) -> Result<()> {
    // Before anything is traced for nothing.
    let out = Out::of(words)?;
    let scene = read(&words.scene)?;
    scene.warnings.iter().for_each(|warning| print::note(warning));
    let all = frames_of(&scene);
    let last = frames.last.unwrap_or(all - 1);
    if frames.first > last || last >= all {
        let message = format!("--frames: expected some from 0 to {}, as the scene has them", all - 1);
        return Err(MeasureError::Words(message).into());
    }
    let animation = &scene.animation;
    let rate = FrameRate::of(all, animation.end - animation.start);
    let times = animation.times(all).enumerate().skip(frames.first as usize);
    let times: Vec<(usize, f64)> = times.take((last - frames.first) as usize + 1).collect();
    let tiles = Tiles::new(words.size, words.tile).count();
    let bar = Bar::of_tiles(&scene.name, tiles * times.len());
    let mut shots = Shots::new(scene, words)?;
    let written = out.write(&times, rate, words.size, |time| shots.next(time, words, &bar));
    bar.end();
    written?;
    let (Shots { rays, seconds, .. }, FrameRate { pictures, seconds: in_seconds }) = (shots, rate);
    let ((width, height), count) = (words.size, times.len());
    let speed = match out {
        // Nothing but the film goes there.
        Out::Pipe => return Ok(()),
        Out::Video(_) => {
            format!(" at {:.4} a second", f64::from(pictures) / f64::from(in_seconds))
        }
        Out::Pictures(..) => String::new(),
    };
    print::line(&format!(
        "{}: {count} frames{speed}, {width} x {height}, {} rays in {seconds:.3} s, {:.2} M/s, {:.2} frames/s",
        out.name(),
        rays.rays(),
        rays.rays() as f64 / seconds / 1e6,
        count as f64 / seconds,
    ))
}

/// Where frames go.
enum Out {
    Video(PathBuf),
    Pipe,
    Pictures(Numbered, Writer),
}

impl Out {
    fn of(words: &RenderWords) -> Result<Self> {
        let path = words.out.as_deref().unwrap_or(Path::new("-"));
        if path == Path::new("-") {
            if io::stdout().is_terminal() {
                let message = "--out -: a film is nothing for a terminal; send it to a program or a file";
                return Err(MeasureError::Words(message.to_owned()).into());
            }
            return Ok(Self::Pipe);
        }
        let text = path.to_string_lossy();
        if path.is_dir() || text.ends_with(['/', std::path::MAIN_SEPARATOR]) {
            let name = path.join(format!("{}-%04d.png", stem(&words.scene)));
            let numbered = Numbered::of(&name).context("a folder's name has another number in it")?;
            std::fs::create_dir_all(path).with_context(|| format!("cannot create {}", path.display()))?;
            return Ok(Self::Pictures(numbered, writer(&name)?));
        }
        if let Some(numbered) = Numbered::of(path) {
            return Ok(Self::Pictures(numbered, writer(path)?));
        }
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("y4m")) {
            return Ok(Self::Video(path.to_owned()));
        }
        let message = format!(
            "{text}: expected a film (a name that ends in .y4m, or - for standard output), or pictures (a name with \
             %04d in it, or a folder, which ends in /)"
        );
        Err(MeasureError::Words(message).into())
    }

    fn name(&self) -> String {
        match self {
            Self::Video(path) => path.display().to_string(),
            Self::Pipe => "-".to_owned(),
            Self::Pictures(Numbered { before, digits, after }, _) => format!("{before}%0{digits}d{after}"),
        }
    }

    /// Writes the frames, each with its number and time. A film is there whole or not at all, and so is each picture; what
    /// pictures were made before one that failed stay.
    fn write(
        &self,
        times: &[(usize, f64)],
        rate: FrameRate,
        size: (u32, u32),
        mut next: impl FnMut(f64) -> Result<Image>,
    ) -> Result<()> {
        let mut video = |out: &mut dyn Write| -> Result<()> {
            let mut video = Video::new(out, size, rate)?;
            for (_, time) in times {
                video.add(&next(*time)?)?;
            }
            Ok(())
        };
        match self {
            Self::Video(path) => write_whole(path, |out| {
                // Whatever went wrong, the file is not written, and the error says why.
                video(out).map_err(|error| error.downcast().unwrap_or_else(io::Error::other))
            })?,
            Self::Pipe => {
                let mut out = BufWriter::new(io::stdout().lock());
                video(&mut out)?;
                out.flush()?;
            }
            Self::Pictures(numbered, write) => {
                for (number, time) in times {
                    let image = next(*time)?;
                    write_whole(&numbered.name(*number), |out| write(&image, out))?;
                }
            }
        }
        Ok(())
    }
}

/// A file's name with a place for a number, as `printf` has it: `%d`, or `%04d` for at least four digits.
#[derive(Debug, PartialEq)]
struct Numbered {
    before: String,
    digits: usize,
    after: String,
}

impl Numbered {
    /// None without such a place, or with two.
    fn of(path: &Path) -> Option<Self> {
        let text = path.to_str()?;
        let (before, rest) = text.split_once('%')?;
        let (digits, after) = rest.split_once('d')?;
        let digits = match digits.strip_prefix('0') {
            Some(digits) => digits.parse().ok().filter(|digits| (1..=9).contains(digits))?,
            None if digits.is_empty() => 1,
            None => return None,
        };
        // In the folder's name it would be many folders.
        let is_folder = after.contains(['/', std::path::MAIN_SEPARATOR]);
        (!after.contains('%') && !is_folder).then(|| Self {
            before: before.to_owned(),
            digits,
            after: after.to_owned(),
        })
    }

    fn name(&self, number: usize) -> PathBuf {
        PathBuf::from(format!("{}{number:0digits$}{}", self.before, self.after, digits = self.digits))
    }
}

/// Goes through a scene and takes its pictures.
struct Shots {
    team: Threads,
    scheme: tiles::Scheme<Threads>,
    film: Film<Threads>,
    moving: Moving,
    upkeep: frames::Scheme,
    look: Look,
    /// From where all frames are seen, where the scene has no camera of its own or another was asked for; and the light
    /// of a scene that has none.
    stands: Option<(Option<Eye>, Option<PointLight>)>,
    rays: Counts,
    /// In which frames were made.
    seconds: f64,
}

impl Shots {
    fn new(scene: Scene, words: &RenderWords) -> Result<Self> {
        let (team, scheme) = checked(words)?;
        let items = World::count(&scene);
        anyhow::ensure!(u32::try_from(items).is_ok(), "{items} triangles and spheres are more than 2^32 - 1");
        let (width, height) = words.size;
        let film = Film::new(&team, width, height).context("the picture is too large")?;
        let look = Look { depth: words.depth, ..Look::of(&scene) };
        let builder = Builder::new(BUILDER, &Settings::default())?;
        let moving = Moving::new(scene, builder, words.levels, TriangleKind::Watertight);
        let upkeep = frames::Scheme::new(UPKEEP, BTreeMap::new(), frames::Mode::Interactive)?;
        let (rays, seconds) = (Counts::default(), 0.0);
        Ok(Self { team, scheme, film, moving, upkeep, look, stands: None, rays, seconds })
    }

    /// The picture of a time, in seconds.
    fn next(&mut self, time: f64, words: &RenderWords, bar: &Bar) -> Result<Image> {
        let before = self.team.now();
        self.moving.advance(time);
        self.upkeep.next(&mut self.moving)?;
        let aspect = words.size.0 as f32 / words.size.1 as f32;
        if self.stands.is_none() {
            self.stands = Some(self.standing(words, aspect)?);
        }
        let (eye, light) = self.stands.expect("it was just found");
        if let Some(light) = light {
            self.moving.world_mut().add_light(light);
        }
        let own = || self.moving.view(aspect).and_then(|view| Eye::of_view(&view, aspect, words.size));
        let eye = eye.or_else(own).with_context(|| format!("at {time} s the camera looks nowhere"))?;
        let tracer = Tracer::new(self.moving.world(), self.moving.hierarchy(), self.look);
        self.rays += trace(&self.team, &mut self.scheme, tracer, eye, words.tile, &mut self.film, bar)?;
        self.seconds += (self.team.now() - before) as f64 / self.team.ticks_per_nanosecond() / 1e9;
        Ok(self.film.image())
    }

    /// What does not move with the scene, found as it is in the first frame.
    fn standing(&self, words: &RenderWords, aspect: f32) -> Result<(Option<Eye>, Option<PointLight>)> {
        let (world, hierarchy) = (self.moving.world(), self.moving.hierarchy());
        let scene = world.scene();
        let has_own = scene.view.is_some() || scene.animation.camera.is_some();
        let within = || view_within(world, hierarchy, aspect).filter(|_| !has_own);
        let camera = match &words.camera {
            Some(camera) => looking(camera, scene, aspect)?,
            None => within()
                .or_else(|| default_view(scene, aspect))
                .context("there is nothing to see in it; give --camera")?,
        };
        let light = scene.lights.is_empty().then(|| light_at(&camera, scene));
        let (width, height) = words.size;
        let moves = has_own && words.camera.is_none();
        Ok(((!moves).then(|| Eye::new(&camera, width, height)), light))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_where_the_name_says() {
        let name = |text: &str, number| {
            Numbered::of(Path::new(text)).map(|numbered| numbered.name(number).display().to_string())
        };
        assert_eq!(name("a/b-%04d.png", 7).as_deref(), Some("a/b-0007.png"));
        assert_eq!(name("%d.exr", 12).as_deref(), Some("12.exr"));
        assert_eq!(name("%03d", 12345).as_deref(), Some("12345"));
        for wrong in ["a.png", "%4d.png", "%00d", "%s.png", "%04d-%04d.png", "%04d/a.png", "100%", "%099999d"]
        {
            assert_eq!(name(wrong, 1), None, "{wrong}");
        }
    }
}
