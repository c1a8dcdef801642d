use clap::Args;

use crate::process;

/// On how many threads frames are measured.
#[derive(Args)]
pub(super) struct Threads {
    /// Numbers of threads, one measurement for each; 0 is one for each core.
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "1,0",
        value_name = "N,N,…"
    )]
    threads: Vec<usize>,
}

impl Threads {
    /// [`thread_counts`].
    pub(super) fn counts(&self) -> anyhow::Result<Vec<usize>> {
        thread_counts(&self.threads)
    }
}

/// Each number once, in order; 0 is one for each core.
pub(super) fn thread_counts(wanted: &[usize]) -> anyhow::Result<Vec<usize>> {
    let mut all = vec![];
    for &wanted in wanted {
        let threads = process::threads(wanted)?;
        if !all.contains(&threads) {
            all.push(threads);
        }
    }
    Ok(all)
}
