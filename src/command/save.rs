//! `apportion scene NAME --save FILE.aff`: any scene as AFF.

use super::{print, render};
use anyhow::Result;
use apportion::measure::MeasureError;
use apportion::record::write_whole;
use apportion::scene::to_aff;
use std::path::Path;

/// Writes a scene and its textures, and tells what AFF cannot say of it.
pub(crate) fn save(scene: &str, file: &Path) -> Result<()> {
    let extension = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if extension != "aff" {
        let told = format!("{}: expected a name that ends in .aff", file.display());
        return Err(MeasureError::Words(told).into());
    }
    let written = to_aff(&render::read(scene)?, &file.file_stem().unwrap_or_default().to_string_lossy());
    written.warnings.iter().for_each(|warning| print::note(warning));
    // The textures first, so that whoever sees the scene sees them, too.
    for (name, bytes) in &written.pictures {
        write_whole(&file.with_file_name(name), |out| out.write_all(bytes))?;
    }
    write_whole(file, |out| out.write_all(written.text.as_bytes()))?;
    let (lines, textures) = (written.text.lines().count(), written.pictures.len());
    print::line(&format!("{}: {lines} lines, {textures} textures beside it", file.display()))
}
