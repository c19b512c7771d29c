//! Times apportion beside other crates, in one run: `cargo run --release -- WORD` in this folder.
//!
//! | word | what |
//! |---|---|
//! | `boxes` | random boxes culled: ours flat and as a tree, bevy, treeculler, parry |
//! | `bodies [FILE]` | two bodies of triangles asked whether they touch, and their trees built: ours, parry; two threads |
//! | `rays [FILE]` | rays through triangles: ours one by one and in packets, obvhs |
//!
//! FILE is a mesh of any format that apportion reads, a bunny by intention; without it a bumpy ball is made, for rays a shell.

mod bodies;
mod boxes;
mod clock;
mod rays;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["boxes"] => boxes::study(),
        ["bodies"] => bodies::study(None),
        ["bodies", file] => bodies::study(Some(Path::new(file))),
        ["rays"] => rays::study(None),
        ["rays", file] => rays::study(Some(Path::new(file))),
        _ => {
            eprintln!("expected `boxes`, `bodies [FILE]` or `rays [FILE]`");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}
