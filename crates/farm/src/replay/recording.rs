use std::{
    fs::File,
    io::{self, Read},
    path::{Path, PathBuf},
    time::Duration,
};

use glam::UVec2;
use lie_protocol::{SceneHash, TileRequest, limit};
use serde::{Deserialize, Serialize};

/// The format of recordings that this build writes and reads.
const FORMAT: u32 = 1;

/// Longest time of a tile, in microseconds: an hour.
const LONGEST_US: f64 = 3.6e9;

/// Longest file, in bytes: some ten times what the largest frame's smallest tiles take.
const LONGEST_FILE: u64 = 256 << 20;

/// What the tiles of one frame cost on one thread of some machine, cut in several ways. A JSON file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Recording {
    /// The format's version.
    format: u32,
    /// What was rendered, and how: for people, but for the scene's hash.
    pub subject: RecordedSubject,
    /// Columns and rows.
    size: [u32; 2],
    /// The frame's tiles, by their side.
    cuts: Vec<Cut>,
}

/// What a recording is of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RecordedSubject {
    /// The scene's name.
    pub scene: String,
    /// The hash of its bytes, in hexadecimal: a farm of another scene does not take the recording.
    pub hash: String,
    /// The camera's name.
    pub camera: String,
    /// How visibility was found.
    pub integrator: String,
    /// Camera rays per pixel.
    pub samples_per_pixel: u32,
    /// Share of the light evaluations that LIEs answered.
    pub trusted_fraction: f64,
    /// The processor.
    pub cpu: String,
}

/// A frame's tiles of one side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Cut {
    side: u32,
    /// Microseconds of each tile, row by row.
    cost_us: Vec<f64>,
}

/// Why there is no recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// The file cannot be read.
    #[error("cannot read {}: {cause}", path.display())]
    Read {
        /// Which.
        path: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
    /// It is not what it should be; the cause has line and column.
    #[error("{}: this is no recording of tiles: {cause}", path.display())]
    Form {
        /// Which file.
        path: PathBuf,
        /// What is wrong where.
        cause: serde_json::Error,
    },
    /// It says what cannot be.
    #[error("{}: {cause}", path.display())]
    Content {
        /// Which file.
        path: PathBuf,
        /// What is wrong where.
        cause: RecordingFlaw,
    },
}

/// What is wrong with a recording, and where in it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordingFlaw {
    /// Another build wrote it.
    #[error("`format` is {0}, and this build reads {FORMAT}: record anew")]
    Format(u32),
    /// A frame cannot have this size.
    #[error("`size` is {}x{}, with a side outside 1 to {}", .0[0], .0[1], limit::FRAME_SIDE)]
    Size([u32; 2]),
    /// The hash is none.
    #[error("`subject.hash` is not 64 hexadecimal digits")]
    Hash,
    /// There are no tiles.
    #[error("`cuts` is empty")]
    Empty,
    /// A tile cannot have this side.
    #[error("`cuts[{cut}].side` is {side}, outside 1 to {}", limit::TILE_SIDE)]
    Side {
        /// Which cut, from 0.
        cut: usize,
        /// What it says.
        side: u32,
    },
    /// There are too few or too many tiles.
    #[error("`cuts[{cut}].cost_us` has {count} values, and the frame has {expected} such tiles")]
    Count {
        /// Which cut, from 0.
        cut: usize,
        /// How many there are.
        count: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A time is none.
    #[error("`cuts[{cut}].cost_us[{tile}]` is {value}, not a time from 0 to an hour")]
    Cost {
        /// Which cut, from 0.
        cut: usize,
        /// Which tile, from 0.
        tile: usize,
        /// What it says.
        value: f64,
    },
}

impl Recording {
    /// Of a frame of this size: each side with the times of its tiles in microseconds, row by row.
    ///
    /// # Errors
    /// [`RecordingFlaw`] if it cannot be.
    pub fn new(
        subject: RecordedSubject,
        size: UVec2,
        cuts: impl IntoIterator<Item = (u32, Vec<f64>)>,
    ) -> Result<Self, RecordingFlaw> {
        let cuts = cuts.into_iter();
        let recording = Self {
            format: FORMAT,
            subject,
            size: size.to_array(),
            cuts: cuts.map(|(side, cost_us)| Cut { side, cost_us }).collect(),
        };
        recording.validate()?;
        Ok(recording)
    }

    /// Reads a file and checks all of it.
    ///
    /// # Errors
    /// [`RecordingError`], with the file and the place in it.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let bytes = read_within(path, LONGEST_FILE).map_err(|cause| RecordingError::Read {
            path: path.to_owned(),
            cause,
        })?;
        let read = serde_json::from_slice::<Self>(&bytes);
        let recording = read.map_err(|cause| RecordingError::Form {
            path: path.to_owned(),
            cause,
        })?;
        let checked = recording.validate();
        checked.map_err(|cause| RecordingError::Content {
            path: path.to_owned(),
            cause,
        })?;
        Ok(recording)
    }

    /// The scene's hash.
    ///
    /// # Errors
    /// [`RecordingFlaw::Hash`], never of a recording that was made or read.
    pub fn hash(&self) -> Result<SceneHash, RecordingFlaw> {
        let digits = self.subject.hash.as_bytes();
        let digit = |digit: u8| char::from(digit).to_digit(16).map(|digit| digit as u8);
        let mut bytes = [0; 32];
        if digits.len() != 2 * bytes.len() {
            return Err(RecordingFlaw::Hash);
        }
        for (byte, pair) in bytes.iter_mut().zip(digits.chunks_exact(2)) {
            let (high, low) = (digit(pair[0]), digit(pair[1]));
            let (Some(high), Some(low)) = (high, low) else {
                return Err(RecordingFlaw::Hash);
            };
            *byte = 16 * high + low;
        }
        Ok(SceneHash(bytes))
    }

    /// Columns and rows of the frame.
    #[must_use]
    pub fn size(&self) -> UVec2 {
        self.size.into()
    }

    /// Each side of tiles, and what all tiles of this side cost together, from the first cut on.
    pub fn totals(&self) -> impl Iterator<Item = (u32, Duration)> {
        let total = |cut: &Cut| Duration::from_secs_f64(1.0e-6 * cut.cost_us.iter().sum::<f64>());
        self.cuts.iter().map(move |cut| (cut.side, total(cut)))
    }

    /// What a tile costs; `None` if it was not recorded.
    pub(super) fn cost(&self, request: &TileRequest) -> Option<Duration> {
        let (origin, size) = (UVec2::from(request.origin), UVec2::from(request.size));
        let fits = |cut: &&Cut| {
            let expected = (self.size() - origin).min(UVec2::splat(cut.side));
            origin % cut.side == UVec2::ZERO && size == expected
        };
        if !origin.cmplt(self.size()).all() {
            return None;
        }
        let cut = self.cuts.iter().find(fits)?;
        let place = origin / cut.side;
        let index = place.y * self.size[0].div_ceil(cut.side) + place.x;
        let cost_us = cut.cost_us.get(index as usize)?;
        Some(Duration::from_secs_f64(1.0e-6 * cost_us))
    }

    fn validate(&self) -> Result<(), RecordingFlaw> {
        if self.format != FORMAT {
            return Err(RecordingFlaw::Format(self.format));
        }
        let sides = 1..=limit::FRAME_SIDE;
        if !self.size.iter().all(|side| sides.contains(side)) {
            return Err(RecordingFlaw::Size(self.size));
        }
        self.hash()?;
        if self.cuts.is_empty() {
            return Err(RecordingFlaw::Empty);
        }
        for (number, cut) in self.cuts.iter().enumerate() {
            self.validate_cut(number, cut)?;
        }
        Ok(())
    }

    fn validate_cut(&self, number: usize, cut: &Cut) -> Result<(), RecordingFlaw> {
        if !(1..=limit::TILE_SIDE).contains(&cut.side) {
            return Err(RecordingFlaw::Side {
                cut: number,
                side: cut.side,
            });
        }
        let across = |size: u32| size.div_ceil(cut.side) as usize;
        let expected = across(self.size[0]) * across(self.size[1]);
        if cut.cost_us.len() != expected {
            return Err(RecordingFlaw::Count {
                cut: number,
                count: cut.cost_us.len(),
                expected,
            });
        }
        let times = 0.0..=LONGEST_US;
        match cut.cost_us.iter().position(|cost| !times.contains(cost)) {
            None => Ok(()),
            Some(tile) => Err(RecordingFlaw::Cost {
                cut: number,
                tile,
                value: cut.cost_us[tile],
            }),
        }
    }
}

/// A file of at most so many bytes.
fn read_within(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = vec![];
    File::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        let longer = format!("it is longer than {limit} bytes");
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, longer));
    }
    Ok(bytes)
}

#[cfg(test)]
pub(super) mod tests {
    use std::fs;

    use super::*;

    /// Of a frame of three by two tiles of two pixels, the last ones cut off, and of all of it.
    pub(in crate::replay) fn recording() -> Recording {
        let subject = RecordedSubject {
            scene: "a".to_owned(),
            hash: "0a".repeat(32),
            camera: "b".to_owned(),
            integrator: "lie".to_owned(),
            samples_per_pixel: 1,
            trusted_fraction: 0.5,
            cpu: "c".to_owned(),
        };
        let costs = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let cuts = [(2, costs), (8, vec![9.0])];
        Recording::new(subject, UVec2::new(5, 3), cuts).unwrap()
    }

    #[test]
    fn tiles_have_the_costs_of_their_places_and_what_was_not_recorded_has_none() {
        let recording = recording();
        let cost = |origin, size| {
            let request = TileRequest {
                frame: 0,
                tile: 0,
                origin,
                size,
            };
            recording.cost(&request).map(|cost| cost.as_micros())
        };
        assert_eq!(cost([0, 0], [2, 2]), Some(1));
        assert_eq!(cost([2, 0], [2, 2]), Some(2));
        assert_eq!(cost([4, 2], [1, 1]), Some(6));
        assert_eq!(cost([0, 0], [5, 3]), Some(9));
        for (origin, size) in [([1, 0], [2, 2]), ([0, 0], [2, 1]), ([6, 0], [2, 2])] {
            assert_eq!(cost(origin, size), None, "{origin:?} {size:?}");
        }
        assert_eq!(recording.hash(), Ok(SceneHash([10; 32])));
        let totals: Vec<_> = recording.totals().collect();
        let expected = [21, 9].map(Duration::from_micros);
        assert_eq!(totals, [(2, expected[0]), (8, expected[1])]);
    }

    #[test]
    fn broken_files_are_refused_with_file_and_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        let right = serde_json::to_string_pretty(&recording()).unwrap();
        fs::write(&path, &right).unwrap();
        assert_eq!(Recording::read(&path).unwrap(), recording());
        let cases = [
            ("\"format\": 1", "\"format\": 7", "`format` is 7"),
            ("\"format\": 1", "\"frmat\": 1", "line 2"),
            ("0a0a", "0a0", "`subject.hash`"),
            ("0a0a", "zz0a", "`subject.hash`"),
            ("\"side\": 8", "\"side\": 0", "`cuts[1].side` is 0"),
            ("\"side\": 8", "\"side\": 1", "15 such tiles"),
            ("4.0", "-4.0", "`cuts[0].cost_us[3]` is -4"),
            ("4.0", "1e11", "`cuts[0].cost_us[3]`"),
            ("4.0", "\"x\"", "line 2"),
            ("9.0\n", "9.0,\n", "line 3"),
        ];
        for (old, new, part) in cases {
            assert!(right.contains(old), "{old} in {right}");
            fs::write(&path, right.replacen(old, new, 1)).unwrap();
            let error = Recording::read(&path).unwrap_err().to_string();
            assert!(error.contains("a.json"), "{error}");
            assert!(error.contains(part), "{part} in {error}");
        }
        for text in ["", "{}", "[]", &right[..right.len() / 2]] {
            fs::write(&path, text).unwrap();
            assert!(Recording::read(&path).is_err(), "{text}");
        }
        assert!(Recording::read(folder.path()).is_err());
    }

    #[test]
    fn no_more_of_a_file_is_read_than_a_recording_may_have() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("file");
        fs::write(&path, b"12345").unwrap();
        assert_eq!(read_within(&path, 5).unwrap(), b"12345");
        let error = read_within(&path, 4).unwrap_err();
        assert!(error.to_string().contains("longer than 4 bytes"));
        #[cfg(unix)]
        assert!(read_within(Path::new("/dev/zero"), 1000).is_err());
    }
}
