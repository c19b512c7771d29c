//! The words of `render`.

use apportion::job::trace::Levels;
use clap::Args;
use std::path::PathBuf;

pub(crate) const RENDER_EXAMPLES: &str = "Examples:
  apportion render room
  apportion render sponza.obj --camera=-12,1.5,0.3:0,3.5,0:60 --size 1024x768 --out sponza.exr
  apportion render kitchen.aff --frame 300 --depth 3
  apportion render bart-museum-5 --frames .. --out museum.y4m
  apportion render bart-robots --frames 100..199 --out robots/%04d.png
  apportion render corner --scheme static_blocks --processors 2";

/// The words of `render`.
#[derive(Debug, Args)]
pub(crate) struct RenderWords {
    /// A file (glTF, GLB, OBJ, PLY, STL, URDF, AFF, NFF; also .gz) or the name of a generated scene.
    #[arg(value_name = "FILE|NAME")]
    pub(crate) scene: String,
    /// Where the eye is, the point it looks at, and how wide it opens from bottom to top, in metres and degrees.
    #[arg(long, value_name = "X,Y,Z:X,Y,Z[:DEGREES]", value_parser = camera, allow_hyphen_values = true)]
    pub(crate) camera: Option<CameraWords>,
    /// Which frame of a scene that moves, from 0, as many as it has itself; with --camera, seen from there.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) frame: u32,
    /// Many frames of a scene that moves, first and last included; `A..` goes on to its last, `..` takes all.
    #[arg(long, value_name = "A..B", value_parser = frames, conflicts_with = "frame", requires = "out")]
    pub(crate) frames: Option<FrameWords>,
    /// Pixels across and down.
    #[arg(long, value_name = "WxH", default_value = "640x480", value_parser = size)]
    pub(crate) size: (u32, u32),
    /// The picture: .png in 8 bits, .pfm or .exr in linear 32-bit floats [default: the scene's name, .png]. Of many
    /// frames: a film, .y4m, or `-` for one to standard output; or a picture each, by a name with %04d for the
    /// frame's number, or into a folder.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Over what the hierarchy is: `one` over all triangles in the world, or `two` levels, one over places of meshes that
    /// each have their own. Two take less memory where meshes stand more than once; one is faster.
    #[arg(long, value_name = "one|two", default_value = "one")]
    pub(crate) levels: Levels,
    /// How many times light is followed through mirrors and glass.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=64))]
    pub(crate) depth: u32,
    /// How tiles are shared out.
    #[arg(long, default_value = "decreasing_tiles")]
    pub(crate) scheme: String,
    /// Pixels of a tile across and down.
    #[arg(long, value_name = "WxH", default_value = "32x4", value_parser = size)]
    pub(crate) tile: (u32, u32),
    /// How many threads [default: as many as there are cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=256))]
    pub(crate) processors: Option<u32>,
}

/// Which frames: the first, and the last where it is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FrameWords {
    pub(crate) first: u32,
    pub(crate) last: Option<u32>,
}

fn frames(text: &str) -> Result<FrameWords, String> {
    let number = |text: &str, unsaid: Option<u32>| match text.trim() {
        "" => Some(unsaid),
        word => word.parse().ok().map(Some),
    };
    let ends = text.split_once("..").and_then(|(a, b)| Some((number(a, Some(0))??, number(b, None)?)));
    let words = ends.map(|(first, last)| FrameWords { first, last });
    words
        .filter(|words| words.last.is_none_or(|last| words.first <= last))
        .ok_or_else(|| "expected A..B, A.., ..B or .., such as 100..199, the lesser first".to_owned())
}

/// A camera in words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CameraWords {
    /// Where it is, in metres.
    pub(crate) eye: [f32; 3],
    /// The point it looks at, in metres.
    pub(crate) look: [f32; 3],
    /// Its full vertical angle.
    pub(crate) degrees: f32,
}

fn camera(text: &str) -> Result<CameraWords, String> {
    let point = |text: &str| {
        let numbers: Option<Vec<f32>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
        numbers.and_then(|numbers| <[f32; 3]>::try_from(numbers).ok())
    };
    let parts: Vec<&str> = text.split(':').collect();
    let camera = match parts[..] {
        [eye, look] => point(eye).zip(point(look)).zip(Some(45.0)),
        [eye, look, degrees] => point(eye).zip(point(look)).zip(degrees.trim().parse().ok()),
        _ => None,
    };
    let camera = camera.map(|((eye, look), degrees)| CameraWords { eye, look, degrees });
    camera.ok_or_else(|| "expected X,Y,Z:X,Y,Z or X,Y,Z:X,Y,Z:DEGREES".to_owned())
}

fn size(text: &str) -> Result<(u32, u32), String> {
    let parts = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    let within = parts.filter(|(w, h)| (1..=16_384).contains(w) && (1..=16_384).contains(h));
    within.ok_or_else(|| "expected two numbers from 1 to 16384, such as 640x480".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_read_or_refused() {
        let words = |first, last| Ok(FrameWords { first, last });
        assert_eq!(frames("3..7"), words(3, Some(7)));
        assert_eq!(frames("4..4"), words(4, Some(4)));
        assert_eq!(
            (frames(".."), frames("5.."), frames("..9")),
            (words(0, None), words(5, None), words(0, Some(9)))
        );
        for wrong in ["", "3", "7..3", "a..3", "1..b", "-1..3", "1..=3", "1...3", "99999999999.."] {
            assert!(frames(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn cameras_and_sizes_are_read_or_refused() {
        let expected = CameraWords { eye: [-1.0, 2.0, 3.5], look: [0.0, 0.0, -1e3], degrees: 45.0 };
        assert_eq!(camera("-1,2, 3.5:0,0,-1e3"), Ok(expected));
        assert_eq!(camera("-1,2,3.5:0,0,-1e3:45"), Ok(expected));
        for wrong in ["", "1,2,3", "1,2:3,4,5", "1,2,3:4,5,6:x", "1,2,3:4,5,6:7:8", "1,2,3,4:5,6,7"] {
            assert!(camera(wrong).is_err(), "{wrong}");
        }
        assert_eq!(size("32x4"), Ok((32, 4)));
        for wrong in ["", "32", "0x4", "32x", "32x4x2", "99999x1", "-1x5"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }
}
