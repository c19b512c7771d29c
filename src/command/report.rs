//! `apportion report`.

use super::print;
use super::table::RESULTS;
use super::words::ReportWords;
use anyhow::{Context, Result, bail};
use apportion::record::{RunFolder, write_whole};
use apportion::report::{Run, page};
use std::path::{Component, Path, PathBuf};

/// Writes the page, and says where it is.
pub(crate) fn report(words: &ReportWords) -> Result<()> {
    let folders: Vec<RunFolder> = if words.runs.is_empty() {
        newest(Path::new(RESULTS))?
    } else {
        words.runs.iter().map(|path| RunFolder::at(path)).collect()
    };
    let mut runs = Vec::new();
    for folder in &folders {
        let mut run = Run::read(folder)?;
        run.link = way(&words.out, folder.path())?;
        runs.push(run);
    }
    let html = page(&runs)?;
    if let Some(parent) = words.out.parent().filter(|parent| !parent.as_os_str().is_empty()) {
        std::fs::create_dir_all(parent).with_context(|| format!("cannot create {}", parent.display()))?;
    }
    write_whole(&words.out, |out| out.write_all(html.as_bytes()))?;
    if words.charts {
        for (run, folder) in runs.iter().zip(&folders) {
            write_charts(run, folder)?;
        }
    }
    let weight = html.len().div_ceil(1024);
    let plural = if runs.len() == 1 { "" } else { "s" };
    print::line(&format!("wrote {}: {} run{plural}, {weight} KiB", words.out.display(), runs.len()))
}

/// Writes a run's charts and specifications beside its rows, and says which files those are.
pub(crate) fn write_charts(run: &Run, folder: &RunFolder) -> Result<Vec<PathBuf>> {
    let mut written = Vec::new();
    for chart in run.charts()? {
        let path = folder.path().join(chart.file_name);
        write_whole(&path, |out| out.write_all(chart.text.as_bytes()))?;
        written.push(path);
    }
    Ok(written)
}

/// The newest finished run of each experiment, in the order of their names.
fn newest(results: &Path) -> Result<Vec<RunFolder>> {
    let entries = std::fs::read_dir(results).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .filter(|entry| entry.path().is_dir())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    // An experiment of which no run is finished has nothing to show; the others have.
    let folders: Vec<RunFolder> =
        names.iter().filter_map(|name| RunFolder::newest_finished(results, name).ok()).collect();
    if folders.is_empty() {
        let place = results.display();
        bail!(
            "no finished run in {place}: run an experiment first (`apportion run NAME`), or name a run's folder"
        );
    }
    Ok(folders)
}

/// The relative way from a file to a folder, with slashes.
fn way(file: &Path, folder: &Path) -> Result<String> {
    let absolute = |path: &Path| {
        // The page's file is not there yet, and its folder may not be: only what is can be made canonical.
        let path = std::path::absolute(path).with_context(|| format!("cannot find {}", path.display()))?;
        Ok::<_, anyhow::Error>(std::fs::canonicalize(&path).unwrap_or(path))
    };
    let from =
        absolute(file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new(".")))?;
    let to = absolute(folder)?;
    let (from, to): (Vec<Component<'_>>, Vec<Component<'_>>) =
        (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    let up = from[common..].iter().map(|_| "..".to_owned());
    let down = to[common..].iter().map(|part| part.as_os_str().to_string_lossy().into_owned());
    let parts: Vec<String> = up.chain(down).collect();
    Ok(if parts.is_empty() { ".".to_owned() } else { parts.join("/") })
}
