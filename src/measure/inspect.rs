//! What the commands `scene`, `machine` and `stress` show.

use super::MeasureError;

/// What a scene holds, in lines for a reader.
///
/// # Errors
/// The scene cannot be had.
pub fn scene(name: &str) -> Result<String, MeasureError> {
    Err(MeasureError::Failed(format!("scene `{name}` cannot be described yet")))
}

/// The constants of a machine, or of all of them, in lines for a reader; `calibrate` fits `host` first.
///
/// # Errors
/// There is no such machine, or the fit failed.
pub fn machine(name: Option<&str>) -> Result<String, MeasureError> {
    Err(MeasureError::Failed(format!("machine `{}` cannot be described yet", name.unwrap_or("all"))))
}

/// Holds the invariants of a scheme or primitive under load on real threads, for so many seconds.
///
/// # Errors
/// An invariant broke, or there is nothing of that name.
pub fn stress(what: &str, processors: u32, seconds: u64) -> Result<String, MeasureError> {
    let load = format!("{processors} processors for {seconds} s");
    Err(MeasureError::Failed(format!("`{what}` cannot be stressed yet with {load}")))
}
