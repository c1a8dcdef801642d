//! Writes the seeds of all targets to a folder, as cargo-fuzz wants them:
//!
//!     cargo run -p lie-trial --example seeds -- fuzz/corpus

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a tool")]

use std::{fs, path::PathBuf};

use lie_trial::TARGETS;

fn main() {
    let folder = std::env::args().nth(1).expect("a folder to write to");
    for target in TARGETS {
        let folder = PathBuf::from(&folder).join(target.name);
        fs::create_dir_all(&folder).unwrap();
        let seeds = (target.seeds)();
        for (number, seed) in seeds.iter().enumerate() {
            fs::write(folder.join(format!("seed-{number:03}")), seed).unwrap();
        }
        let bytes: usize = seeds.iter().map(Vec::len).sum();
        println!("{}: {} seeds, {bytes} bytes", target.name, seeds.len());
    }
}
