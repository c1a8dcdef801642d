use std::{
    ffi::OsString,
    fs,
    io::Read,
    path::{Path, PathBuf},
    process::Command,
};

use glam::{UVec2, Vec3};
use lie_render::Film;

/// Another program that renders a flat scene and says how long it took.
///
/// It is called as `PROGRAM SCENE --threads N --reps R --variant A,B,.. --area S --nobuild
/// --out PREFIX`, renders a frame of each variant, R times or more, with S × S shadow rays to each
/// area light, and prints for each one line of seventeen words:
///
/// ```text
/// scene.bin v31300 T2 pix16 median 0.0123 min 0.0120 s shadow_rays 1234 1.2 Mray/s mean 0.5 clean 5/5
/// ```
///
/// Times are seconds, rays are `primary_rays` or `shadow_rays`, and *clean* are the frames in which it
/// had its cores to itself. Linear radiance goes to `PREFIX.VARIANT.npy`: height × width × 3 `f32`,
/// row 0 on top; of a variant of primary rays it is the cosine between normal and ray.
#[derive(Clone, Debug)]
pub struct Harness {
    /// The program.
    pub program: PathBuf,
}

/// What a [`Harness`] is asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Order<'a> {
    /// The flat file.
    pub(super) scene: &'a Path,
    pub(super) variants: &'a [String],
    pub(super) threads: usize,
    /// Clean frames of each variant; 0 is a single frame of any kind.
    pub(super) frames: u32,
    /// Shadow rays along each side of an area light.
    pub(super) area_side: u32,
    /// Where pictures go, if there is a wish for any.
    pub(super) pictures: Option<&'a Path>,
}

/// A line of a [`Harness`].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Reading {
    /// Median of its frames, in milliseconds.
    pub(super) frame_ms: f64,
    /// Whether the rays are primary ones.
    pub(super) is_primary: bool,
    pub(super) rays: u64,
    pub(super) clean: Clean,
}

/// Frames in which a program had its cores to itself, and all that it rendered for them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clean {
    /// Those that had.
    pub frames: u32,
    /// All.
    pub tries: u32,
}

/// Why another program could not be measured.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PeerError {
    /// It cannot be started: it is missing, or not an executable.
    #[error("{program}: cannot be run: {source}")]
    Start {
        /// The program.
        program: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// It ended with an error.
    #[error("{program}: failed, {status}: {complaint}")]
    Failed {
        /// The program.
        program: PathBuf,
        /// How it ended.
        status: std::process::ExitStatus,
        /// The last that it wrote to standard error.
        complaint: String,
    },
    /// It printed something else than a [`Harness`] does.
    #[error("{program}: {problem}")]
    Output {
        /// The program.
        program: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// A picture of it is missing or is none.
    #[error("{path}: {problem}")]
    Picture {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// The scene has something that the flat format cannot say.
    #[error("cannot be written for another program: {0}")]
    Scene(String),
    /// The flat file could not be written.
    #[error("cannot write a scene for another program: {0}")]
    File(#[from] std::io::Error),
}

impl Harness {
    /// Whether there is a program at all, as far as that can be seen without running it.
    ///
    /// # Errors
    /// [`PeerError::Start`] if it is no file.
    pub fn check(&self) -> Result<(), PeerError> {
        let is_file = fs::metadata(&self.program).and_then(|found| match found.is_file() {
            true => Ok(()),
            false => Err(std::io::Error::other("it is no file")),
        });
        is_file.map_err(|source| PeerError::Start {
            program: self.program.clone(),
            source,
        })
    }

    /// A reading for each variant, in order.
    pub(super) fn run(&self, order: &Order<'_>) -> Result<Vec<Reading>, PeerError> {
        // A name without a folder is a file here, not one of the search path.
        let program = self.program.canonicalize();
        let output = program
            .and_then(|program| Command::new(program).args(arguments(order)).output())
            .map_err(|source| PeerError::Start {
                program: self.program.clone(),
                source,
            })?;
        if !output.status.success() {
            let complaint = String::from_utf8_lossy(&output.stderr);
            let last = complaint.lines().rfind(|line| !line.trim().is_empty());
            return Err(PeerError::Failed {
                program: self.program.clone(),
                status: output.status,
                complaint: shorten(last.unwrap_or("it does not say why")),
            });
        }
        let text = String::from_utf8_lossy(&output.stdout);
        readings(&text, order).map_err(|problem| PeerError::Output {
            program: self.program.clone(),
            problem,
        })
    }
}

fn arguments(order: &Order<'_>) -> Vec<OsString> {
    let mut arguments: Vec<OsString> = vec![order.scene.into()];
    for (option, value) in [
        ("--threads", order.threads.to_string()),
        ("--reps", order.frames.to_string()),
        ("--variant", order.variants.join(",")),
        ("--area", order.area_side.to_string()),
    ] {
        arguments.extend([option.into(), value.into()]);
    }
    arguments.push("--nobuild".into());
    if let Some(prefix) = order.pictures {
        arguments.extend(["--out".into(), prefix.into()]);
    }
    arguments
}

/// The line of each variant, whatever their order; nothing else may be there.
fn readings(text: &str, order: &Order<'_>) -> Result<Vec<Reading>, String> {
    let mut found: Vec<Option<Reading>> = vec![None; order.variants.len()];
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        let not_understood = || format!("printed what is not understood: {}", shorten(line));
        let (name, threads, reading) = reading(line).ok_or_else(not_understood)?;
        if threads != order.threads {
            return Err(format!(
                "was to take {} threads, and took {threads}",
                order.threads
            ));
        }
        let index = order.variants.iter().position(|variant| variant == name);
        found[index.ok_or_else(not_understood)?] = Some(reading);
    }
    let named = found.into_iter().zip(order.variants);
    named
        .map(|(reading, name)| reading.ok_or_else(|| format!("printed nothing about '{name}'")))
        .collect()
}

/// Name, threads and figures of a line.
fn reading(line: &str) -> Option<(&str, usize, Reading)> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let &[
        _,
        _,
        threads,
        name,
        "median",
        median,
        "min",
        _,
        "s",
        kind,
        rays,
        _,
        "Mray/s",
        "mean",
        _,
        "clean",
        clean,
    ] = &words[..]
    else {
        return None;
    };
    let is_primary = match kind {
        "primary_rays" => true,
        "shadow_rays" => false,
        _ => return None,
    };
    let median_s: f64 = median.parse().ok()?;
    let (frames, tries) = clean.split_once('/')?;
    let reading = Reading {
        frame_ms: 1.0e3 * median_s,
        is_primary,
        rays: rays.parse().ok()?,
        clean: Clean {
            frames: frames.parse().ok()?,
            tries: tries.parse().ok()?,
        },
    };
    // A time of 0 is rounded away: no ratio can be made of it.
    let is_time = median_s > 0.0 && median_s.is_finite();
    let threads = threads.strip_prefix('T')?.parse().ok()?;
    is_time.then_some((name, threads, reading))
}

/// Reads the picture of a variant.
pub(super) fn read_picture(prefix: &Path, variant: &str, size: UVec2) -> Result<Film, PeerError> {
    let mut path = prefix.as_os_str().to_owned();
    path.push(format!(".{variant}.npy"));
    let path = PathBuf::from(path);
    let failed = |problem: String| PeerError::Picture {
        path: path.clone(),
        problem,
    };
    let bytes = read_up_to(&path, most_bytes(size))
        .map_err(|error| failed(format!("cannot be read: {error}")))?;
    let radiance = npy(&bytes, size)
        .ok_or_else(|| failed(format!("is no .npy of {} x {} x 3 float32", size.y, size.x)))?;
    Film::from_radiance(size, radiance).ok_or_else(|| failed("has another size".to_owned()))
}

/// Most bytes of a picture's file: a header of version 1, and the pixels.
fn most_bytes(size: UVec2) -> u64 {
    10 + u64::from(u16::MAX) + 12 * u64::from(size.x) * u64::from(size.y)
}

/// A file's bytes, and one more than `most` of one that is longer: no picture has so many.
fn read_up_to(path: &Path, most: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = vec![];
    fs::File::open(path)?
        .take(most + 1)
        .read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// NumPy's format, version 1, as far as a picture needs it.
fn npy(bytes: &[u8], size: UVec2) -> Option<Vec<Vec3>> {
    let rest = bytes.strip_prefix(b"\x93NUMPY\x01\x00")?;
    let (length, rest) = rest.split_first_chunk::<2>()?;
    let (header, data) = rest.split_at_checked(usize::from(u16::from_le_bytes(*length)))?;
    let header = std::str::from_utf8(header).ok()?;
    let shape = format!("'shape': ({}, {}, 3)", size.y, size.x);
    let parts = ["'descr': '<f4'", "'fortran_order': False", &shape];
    let is_picture = parts.iter().all(|part| header.contains(part));
    if !is_picture || data.len() != 12 * size.x as usize * size.y as usize {
        return None;
    }
    let values: Vec<f32> = data
        .chunks_exact(4)
        .map(|value| f32::from_le_bytes([value[0], value[1], value[2], value[3]]))
        .collect();
    let is_radiance = values.iter().all(|value| value.is_finite());
    is_radiance.then(|| values.chunks_exact(3).map(Vec3::from_slice).collect())
}

/// The beginning of what may be long.
fn shorten(text: &str) -> String {
    const MOST: usize = 120;
    let mut short: String = text.trim().chars().take(MOST).collect();
    if short.len() < text.trim().len() {
        short.push('…');
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: &str = "a.bin v31300 T2 pix16     median 0.0123 min 0.0120 s  shadow_rays 1234  \
                        1.20 Mray/s  mean 0.500000  clean 1/3";

    fn parse(text: &str, variants: &[&str]) -> Result<Vec<Reading>, String> {
        let variants: Vec<String> = variants.iter().map(|&name| name.to_owned()).collect();
        let order = Order {
            scene: Path::new("a.bin"),
            variants: &variants,
            threads: 2,
            frames: 1,
            area_side: 8,
            pictures: None,
        };
        readings(text, &order)
    }

    #[test]
    fn lines_are_read() {
        let both = format!("{}\n\n{LINE}\n", LINE.replace("pix16", "occ1"));
        let read = parse(&both, &["pix16", "occ1"]).unwrap();
        assert_eq!(read[0], read[1]);
        assert!((read[0].frame_ms - 12.3).abs() < 1.0e-9 && !read[0].is_primary);
        assert_eq!(read[0].rays, 1234);
        assert_eq!(
            read[0].clean,
            Clean {
                frames: 1,
                tries: 3
            }
        );
    }

    #[test]
    fn anything_else_is_not_understood() {
        for (wrong, problem) in [
            ("hello".to_owned(), "not understood: hello"),
            (LINE.replace("0.0123", "0.0000"), "not understood"),
            (LINE.replace("0.0123", "NaN"), "not understood"),
            (LINE.replace("median", "mean"), "not understood"),
            (LINE.replace("1/3", "3"), "not understood"),
            (LINE.replace("pix16", "pix99"), "not understood"),
            (LINE.replace("T2", "T1"), "2 threads, and took 1"),
            (String::new(), "nothing about 'pix16'"),
        ] {
            let error = parse(&wrong, &["pix16"]).unwrap_err();
            assert!(error.contains(problem), "{error}");
        }
        assert!(parse(&"x".repeat(1000), &["occ1"]).unwrap_err().len() < 200);
    }

    #[test]
    fn pictures_of_another_kind_are_refused() {
        let picture = |header: &str, values: usize| {
            let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
            bytes.extend((header.len() as u16).to_le_bytes());
            bytes.extend(header.as_bytes());
            bytes.extend((0..values).flat_map(|value| (value as f32).to_le_bytes()));
            bytes
        };
        let right = "{'descr': '<f4', 'fortran_order': False, 'shape': (1, 2, 3), }\n";
        let size = UVec2::new(2, 1);
        let pixels = npy(&picture(right, 6), size).unwrap();
        assert_eq!(pixels, [Vec3::new(0.0, 1.0, 2.0), Vec3::new(3.0, 4.0, 5.0)]);
        assert!(npy(&picture(right, 5), size).is_none());
        assert!(npy(&picture(&right.replace("f4", "f8"), 6), size).is_none());
        assert!(npy(&picture(right, 6), UVec2::new(1, 2)).is_none());
        assert!(npy(b"\x93NUMPY\x01\x00\xff\xff", size).is_none());
        assert!(npy(b"", size).is_none());
    }

    #[test]
    fn of_a_file_that_never_ends_no_more_is_read_than_a_picture_has() {
        let size = UVec2::new(2, 1);
        let endless = Path::new("/dev/zero");
        if !endless.exists() {
            eprintln!("SKIPPED: there is no /dev/zero");
            return;
        }
        let bytes = read_up_to(endless, most_bytes(size)).unwrap();
        assert_eq!(bytes.len() as u64, most_bytes(size) + 1);
        assert!(npy(&bytes, size).is_none());
    }
}
