//! Recorded paths as CSV: one line a frame; positions in metres, `fov_y` in degrees.

use std::fmt::Write as _;
use std::path::Path;

use glam::Vec3;

use super::super::SceneError;
use super::super::source::Source;
use super::{ASPECT, CameraPath};
use crate::geometry::{Camera, Lens};

/// The columns: eye, point looked at, up direction, full vertical angle.
const HEADER: &str = "eye_x,eye_y,eye_z,look_x,look_y,look_z,up_x,up_y,up_z,fov_y";

impl CameraPath {
    /// Reads a recorded path. The recording holds positions in metres and the full vertical angle in
    /// degrees; pictures are taken as 4:3, and the depth range is the caller's, in metres.
    ///
    /// # Errors
    /// [`SceneError`] naming file, line and column if the file cannot be read, a number is missing or
    /// is none, or a frame has no direction: the point looked at is the eye, or up lies along the gaze.
    pub fn read_csv(path: impl AsRef<Path>, near: f32, far: f32) -> Result<Self, SceneError> {
        let source = Source::open(path.as_ref())?;
        let file = &source.file;
        let mut lines = source.text()?.lines().enumerate();
        let header = lines.next().map_or("", |(_, line)| line.trim_end());
        if header != HEADER {
            return Err(SceneError::malformed(file, "line 1", format!("{header:?}"), HEADER));
        }
        let mut frames = Vec::new();
        for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
            let place = format!("line {}", index + 1);
            let numbers = numbers(line).map_err(|(column, found)| {
                SceneError::malformed(file, format!("{place}, {column}"), found, "a finite number")
            })?;
            let [ex, ey, ez, lx, ly, lz, ux, uy, uz, degrees] = numbers;
            let lens = Lens::Symmetric { fov_y: f64::from(degrees).to_radians() as f32, aspect: ASPECT };
            let (eye, look, up) = (Vec3::new(ex, ey, ez), Vec3::new(lx, ly, lz), Vec3::new(ux, uy, uz));
            let camera = Camera::look_at(eye, look, up, lens, near, far).map_err(|error| {
                SceneError::malformed(file, place, error.to_string(), "a camera that can see")
            })?;
            frames.push(camera);
        }
        Ok(Self { frames })
    }

    /// Writes the path as a recording; off-axis lenses are written by the angle they open up and down.
    ///
    /// # Errors
    /// [`SceneError::Write`] if the file cannot be written.
    pub fn write_csv(&self, path: impl AsRef<Path>) -> Result<(), SceneError> {
        let mut text = format!("{HEADER}\n");
        for camera in &self.frames {
            let [_, _, bottom, top] = camera.lens.tangents();
            let degrees = (top.atan() - bottom.atan()).to_degrees() as f32;
            let (eye, up) = (camera.eye, camera.up);
            let look = eye + camera.forward;
            for point in [eye, look, up] {
                // Display prints as many digits as it takes to read the same f32 back.
                let _ = write!(text, "{},{},{},", point.x, point.y, point.z);
            }
            let _ = writeln!(text, "{degrees}");
        }
        let path = path.as_ref();
        std::fs::write(path, text)
            .map_err(|source| SceneError::Write { file: path.display().to_string(), source })
    }
}

/// The ten numbers of a line, or the first column that is wrong and what is in it.
fn numbers(line: &str) -> Result<[f32; 10], (String, String)> {
    let mut fields = line.trim_end().split(',');
    let mut numbers = [0.0; 10];
    for (number, name) in numbers.iter_mut().zip(HEADER.split(',')) {
        let field = fields.next().ok_or_else(|| (format!("column {name}"), "nothing".to_string()))?;
        *number = field
            .trim()
            .parse()
            .ok()
            .filter(|number: &f32| number.is_finite())
            .ok_or_else(|| (format!("column {name}"), format!("{field:?}")))?;
    }
    match fields.next() {
        Some(more) => Err(("column 11".to_string(), format!("{more:?} after the last column"))),
        None => Ok(numbers),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;

    fn read(body: &str) -> Result<CameraPath, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("walk.csv");
        std::fs::write(&path, body).unwrap();
        CameraPath::read_csv(&path, 0.1, 100.0).map_err(|error| error.to_string())
    }

    #[test]
    fn written_paths_read_back() {
        let bounds = Aabb { min: Vec3::ZERO, max: Vec3::splat(10.0) };
        let path = CameraPath::fly_through(&bounds, 100, 5);
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("walk.csv");
        path.write_csv(&file).unwrap();
        let first = path.frames[0];
        let back = CameraPath::read_csv(&file, first.near, first.far).unwrap();
        assert_eq!(path.frames.len(), back.frames.len());
        for (a, b) in path.frames.iter().zip(&back.frames) {
            assert!(a.eye == b.eye && (a.forward - b.forward).length() < 1e-5);
            assert!(
                (a.up - b.up).length() < 1e-5 && (a.lens.tangents()[3] - b.lens.tangents()[3]).abs() < 1e-5
            );
        }
    }

    #[test]
    fn faults_are_named_with_line_and_column() {
        let good = "0,0,0,1,0,0,0,1,0,60";
        assert_eq!(read(&format!("\u{feff}{HEADER}\r\n{good}\r\n\r\n")).unwrap().frames.len(), 1);
        for (body, part) in [
            (String::new(), "walk.csv: line 1: \"\"; expected eye_x"),
            (format!("{HEADER}\n{good}\n0,0,0,1,0,0,0,one,0,60"), "line 3, column up_y: \"one\""),
            (format!("{HEADER}\n0,0,0,1,0,0,0,1,0"), "line 2, column fov_y: nothing"),
            (format!("{HEADER}\n0,0,0,1,0,inf,0,1,0,60"), "line 2, column look_z: \"inf\""),
            (format!("{HEADER}\n{good},7"), "line 2, column 11"),
            (format!("{HEADER}\n0,0,0,0,0,0,0,1,0,60"), "line 2: the point looked at is the eye"),
            (format!("{HEADER}\n0,0,0,0,5,0,0,1,0,60"), "line 2: the up direction"),
            (format!("{HEADER}\n0,0,0,1,0,0,0,1,0,180"), "line 2: the lens does not open"),
        ] {
            let error = read(&body).unwrap_err();
            assert!(error.contains(part), "{error:?} lacks {part:?}");
        }
    }
}
