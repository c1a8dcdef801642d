use std::{
    fs,
    io::{BufWriter, Write},
    path::PathBuf,
};

use lie_render::{Film, compare};

use super::{
    Difference, PeerError, PeerRow, PeersConfig, References, Show, Version, area_side,
    closest_hits::closest_hits,
    harness::{Order, Reading},
    write_flat,
};
use crate::{
    BenchError, Contender, Progress, Spread, Stage,
    race::{Entrant, Runs, race, race_round},
};

/// The other program's scene, in a file that goes with this.
pub(super) struct Peer<'a> {
    pub(super) stage: &'a Stage,
    pub(super) folder: tempfile::TempDir,
    pub(super) file: PathBuf,
}

impl<'a> Peer<'a> {
    pub(super) fn new(stage: &'a Stage) -> Result<Self, PeerError> {
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("scene.bin");
        let mut writer = BufWriter::new(fs::File::create(&file)?);
        let (scene, camera) = (stage.world().scene(), stage.camera());
        write_flat(&mut writer, scene, camera, stage.settings().size)?;
        writer.flush()?;
        Ok(Self {
            stage,
            folder,
            file,
        })
    }
}

/// What the rounds on some number of threads gave.
pub(super) struct Rounds<'a> {
    shows: [Show<'a>; 2],
    threads: usize,
    /// Of the other program's variants, round by round.
    readings: Vec<Vec<Reading>>,
    variants: Vec<String>,
    /// Of [`OURS`] in each show.
    runs: Vec<Runs>,
}

/// Ours, in order, of each show.
const OURS: [&str; 3] = [Judged::CLOSEST_HITS, Judged::STANDARD, Judged::LIE];

/// One whose times are known, and whose picture was judged.
pub(super) struct Judged {
    pub(super) row: PeerRow,
    /// Times, round by round.
    pub(super) times_ms: Vec<f64>,
    pub(super) is_primary: bool,
}

impl Judged {
    /// Bare packets of camera rays.
    pub(super) const CLOSEST_HITS: &'static str = "closest hits";
    /// The stage of a frame: hits, and the surfaces there.
    pub(super) const VISIBILITY: &'static str = "visibility";
    /// The standard's frame.
    pub(super) const STANDARD: &'static str = "standard";
    /// The frame with LIEs.
    pub(super) const LIE: &'static str = "lie";
}

impl<'a> Rounds<'a> {
    /// In each round the other program's process, and then one frame of each of ours.
    pub(super) fn run(
        peer: &Peer<'_>,
        shows: [Show<'a>; 2],
        pool: &rayon::ThreadPool,
        config: &PeersConfig,
        progress: &Progress<'_>,
    ) -> Result<Self, BenchError> {
        let threads = pool.current_num_threads();
        for show in &shows {
            let small = show.stage.thumbnail();
            let thumbnails = entrants(&Show {
                stage: &small,
                ..*show
            });
            // Of closest hits' blocks none may be cut.
            race(pool, 1, &thumbnails[1..], &|_, _| {});
        }
        let ours: Vec<Entrant<'_>> = shows.iter().flat_map(entrants).collect();
        let mut readings = vec![vec![]; config.variants.len()];
        let mut runs = vec![];
        for round in 0..config.repeat.max(1) {
            let name = format!("{} of {}", round + 1, config.repeat);
            let what = format!("{}: embree, {threads} threads, {name}", peer.stage.name());
            progress(&what, 0.0);
            let read = config.harness.run(&Order {
                scene: &peer.file,
                variants: &config.variants,
                threads,
                frames: 1,
                area_side: area_side(peer.stage),
                pictures: None,
            })?;
            for (all, reading) in readings.iter_mut().zip(read) {
                all.push(reading);
            }
            race_round(pool, &name, &ours, &mut runs, progress);
        }
        drop(ours);
        Ok(Self {
            shows,
            threads,
            readings,
            variants: config.variants.clone(),
            runs,
        })
    }

    /// Times with errors: the other program's, then ours of each show.
    pub(super) fn judge(&self, references: &References) -> Result<Vec<Judged>, BenchError> {
        let mut judged = vec![];
        for index in 0..self.variants.len() {
            judged.push(self.judge_variant(index, references)?);
        }
        for (show, runs) in self.shows.iter().zip(self.runs.chunks(OURS.len())) {
            for index in 0..OURS.len() {
                judged.push(self.judge_ours(show, index, runs, references)?);
            }
            // The stage's hits are those that were judged as closest hits.
            let (standard, lie) = (&runs[1], &runs[2]);
            let times_ms = lie.visibility_ms();
            let mut row = self.row(show, Judged::VISIBILITY, &times_ms, &standard.film, None)?;
            row.rays = lie.stats.primary_rays;
            judged.push(Judged {
                row,
                times_ms,
                is_primary: true,
            });
        }
        Ok(judged)
    }

    /// One of [`OURS`], whose `runs` are those of one show.
    fn judge_ours(
        &self,
        show: &Show<'_>,
        index: usize,
        runs: &[Runs],
        references: &References,
    ) -> Result<Judged, BenchError> {
        let (name, run, standard) = (OURS[index], &runs[index], &runs[1].film);
        let is_primary = name == Judged::CLOSEST_HITS;
        let other = match (show.version, is_primary) {
            (Version::AsItIs, _) => None,
            (Version::Plain, true) => references.primary(),
            (Version::Plain, false) => references.shaded(),
        };
        let mut row = self.row(show, name, &run.times_ms, &run.film, other)?;
        if is_primary {
            row.rays = run.stats.primary_rays;
        } else {
            let exposure = show.stage.exposure_stops();
            row.relative_rmse = Some(compare(&run.film, standard, exposure)?.relative_rmse);
            row.rays = run.stats.shadow_rays;
        }
        Ok(Judged {
            row,
            times_ms: run.times_ms.clone(),
            is_primary,
        })
    }

    fn judge_variant(&self, index: usize, references: &References) -> Result<Judged, BenchError> {
        let readings = &self.readings[index];
        let is_primary = readings.iter().any(|reading| reading.is_primary);
        let other = match is_primary {
            true => references.primary(),
            false => references.shaded(),
        };
        let times_ms: Vec<f64> = readings.iter().map(|reading| reading.frame_ms).collect();
        let name = format!("embree {}", self.variants[index]);
        let picture = references.of_variant(index);
        let mut row = self.row(&self.shows[0], &name, &times_ms, picture, other)?;
        row.rays = readings.last().map_or(0, |reading| reading.rays);
        let mut clean = super::Clean::default();
        for reading in readings {
            clean.frames += reading.clean.frames;
            clean.tries += reading.clean.tries;
        }
        row.clean = Some(clean);
        Ok(Judged {
            row,
            times_ms,
            is_primary,
        })
    }

    fn row(
        &self,
        show: &Show<'_>,
        who: &str,
        times_ms: &[f64],
        picture: &Film,
        other: Option<&Film>,
    ) -> Result<PeerRow, BenchError> {
        let from_peer = other.map(|other| Difference::between(show.stage, picture, other));
        Ok(PeerRow {
            scene: show.stage.name().to_owned(),
            version: show.version,
            who: who.to_owned(),
            is_best: false,
            threads: self.threads,
            frame_ms: Spread::of(times_ms).unwrap_or(Spread::NONE),
            rays: 0,
            clean: None,
            from_peer: from_peer.transpose()?,
            relative_rmse: None,
        })
    }
}

/// [`OURS`] of a show.
fn entrants<'a>(show: &Show<'a>) -> Vec<Entrant<'a>> {
    let &Show {
        version,
        stage,
        lineup,
    } = show;
    let name = |who: &str| format!("{}, {}: {who}", stage.name(), version.name());
    let mut entrants = vec![Entrant {
        name: name(Judged::CLOSEST_HITS),
        render: Box::new(move |tell| closest_hits(stage, tell)),
    }];
    for (contender, lies) in lineup.iter() {
        let is_ours = matches!(contender, Contender::Standard | Contender::Lie);
        if is_ours {
            entrants.push(Entrant {
                name: name(contender.name()),
                render: Box::new(move |tell| {
                    contender.render(stage, lies.map(|lies| &lies.lies), tell)
                }),
            });
        }
    }
    entrants
}
