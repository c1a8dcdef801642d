//! A first pass over an OBJ file: every line is checked here, where its number is known.

use std::{collections::BTreeSet, path::Path};

use crate::load::{LoadError, source::shorten};

/// What the first pass found.
pub(super) struct Scan {
    /// The lines that tobj shall see: positions, attributes, faces, groups, materials.
    pub(super) text: String,
    /// Arguments of each `mtllib`.
    pub(super) libraries: Vec<String>,
    /// Names that `usemtl` refers to.
    pub(super) materials: BTreeSet<String>,
}

/// Most corners of a face.
const MAX_CORNERS: usize = 1 << 16;

/// The text of a file: UTF-8 or UTF-16 with a byte order mark, else Latin-1.
pub(super) fn decode(path: &Path, bytes: &[u8]) -> Result<String, LoadError> {
    let utf16 = |rest: &[u8], word: fn([u8; 2]) -> u16| {
        let words = rest.chunks_exact(2).map(|pair| word([pair[0], pair[1]]));
        char::decode_utf16(words)
            .collect::<Result<String, _>>()
            .map_err(|_| LoadError::Syntax {
                path: path.to_owned(),
                line: 1,
                column: 1,
                problem: "the file begins like UTF-16, but is not".into(),
            })
    };
    match bytes {
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xef, 0xbb, 0xbf, rest @ ..] => Ok(String::from_utf8_lossy(rest).into_owned()),
        _ => Ok(match std::str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
        }),
    }
}

/// Checks all lines and keeps those that matter.
pub(super) fn scan(path: &Path, text: &str, warnings: &mut Vec<String>) -> Result<Scan, LoadError> {
    let mut state = State {
        path,
        warnings,
        scan: Scan {
            text: String::with_capacity(text.len()),
            libraries: Vec::new(),
            materials: BTreeSet::new(),
        },
        counts: [0; 3],
        group: String::new(),
        attributes: None,
    };
    let mut joined = String::new();
    let mut first = 1;
    for (index, line) in text.lines().enumerate() {
        if joined.is_empty() {
            first = index + 1;
        }
        if let Some(begun) = line.trim_end().strip_suffix('\\') {
            joined.push_str(begun);
            joined.push(' ');
            continue;
        }
        if joined.is_empty() {
            state.line(line, index + 1)?;
        } else {
            joined.push_str(line);
            state.line(&std::mem::take(&mut joined), first)?;
        }
    }
    state.line(&joined, first)?;
    Ok(state.scan)
}

struct State<'a> {
    path: &'a Path,
    warnings: &'a mut Vec<String>,
    scan: Scan,
    /// Positions, texture coordinates and normals so far.
    counts: [usize; 3],
    group: String,
    /// Whether the faces of the current run have texture coordinates and normals.
    attributes: Option<[bool; 2]>,
}

impl State<'_> {
    fn line(&mut self, line: &str, number: usize) -> Result<(), LoadError> {
        let content = line.split('#').next().unwrap_or_default().trim();
        let (keyword, rest) = content
            .split_once(char::is_whitespace)
            .unwrap_or((content, ""));
        let at = Place {
            path: self.path,
            line,
            number,
        };
        match keyword {
            "v" => self.numbers(&at, "v", rest, 3, 0)?,
            "vt" => self.numbers(&at, "vt", rest, 2, 1)?,
            "vn" => self.numbers(&at, "vn", rest, 3, 2)?,
            "f" => self.face(&at, rest)?,
            "l" | "p" => self.warnings.push("lines and points are left out".into()),
            "o" | "g" => {
                let name = rest.trim();
                self.group = if name.is_empty() {
                    "unnamed".into()
                } else {
                    name.into()
                };
                self.push(&format!("o {}", self.group));
            }
            "mtllib" => self.scan.libraries.push(rest.trim().to_owned()),
            "usemtl" => {
                let name = if rest.trim().is_empty() {
                    "unnamed"
                } else {
                    rest.trim()
                };
                if !self.scan.materials.contains(name) {
                    self.scan.materials.insert(name.to_owned());
                }
                self.push(&format!("usemtl {name}"));
            }
            // Curves, surfaces, smoothing groups and what else there may be.
            _ => {}
        }
        Ok(())
    }

    fn push(&mut self, line: &str) {
        self.scan.text.push_str(line);
        self.scan.text.push('\n');
    }

    /// Checks the first `wanted` numbers and keeps them; a colour or weight behind is dropped.
    fn numbers(
        &mut self,
        at: &Place<'_>,
        keyword: &str,
        rest: &str,
        wanted: usize,
        kind: usize,
    ) -> Result<(), LoadError> {
        self.scan.text.push_str(keyword);
        let mut words = rest.split_whitespace();
        for index in 0..wanted {
            let word = match words.next() {
                Some(word) => word,
                // A texture coordinate of a one-dimensional texture.
                None if kind == 1 && index == 1 => "0",
                None => {
                    return Err(at.error(
                        None,
                        &format!("expected {wanted} numbers after '{keyword}', found {index}"),
                    ));
                }
            };
            match word.parse::<f32>() {
                Ok(number) if number.is_finite() => {}
                _ => {
                    return Err(at.error(
                        Some(word),
                        &format!("expected a finite number, found '{}'", shorten(word)),
                    ));
                }
            }
            self.scan.text.push(' ');
            self.scan.text.push_str(word);
        }
        self.scan.text.push('\n');
        self.counts[kind] += 1;
        Ok(())
    }

    fn face(&mut self, at: &Place<'_>, rest: &str) -> Result<(), LoadError> {
        let mut corners = Vec::new();
        for word in rest.split_whitespace() {
            if corners.len() == MAX_CORNERS {
                return Err(at.error(Some(word), &format!("more than {MAX_CORNERS} corners")));
            }
            corners.push(self.corner(at, word)?);
        }
        if corners.len() < 3 {
            let (line, count) = (at.number, corners.len());
            self.warnings.push(format!(
                "line {line}: a face with {count} corners is left out"
            ));
            return Ok(());
        }
        // tobj needs an attribute at every corner of a run, or at none.
        let has = [1, 2].map(|kind| corners.iter().all(|corner| corner[kind].is_some()));
        if self.attributes != Some(has) {
            self.attributes = Some(has);
            let name = if self.group.is_empty() {
                "unnamed"
            } else {
                &self.group
            };
            let line = format!("o {name}");
            self.push(&line);
        }
        self.scan.text.push('f');
        for corner in corners {
            let [Some(position), uv, normal] = corner else {
                continue;
            };
            let word = match (uv.filter(|_| has[0]), normal.filter(|_| has[1])) {
                (Some(uv), Some(normal)) => format!(" {position}/{uv}/{normal}"),
                (Some(uv), None) => format!(" {position}/{uv}"),
                (None, Some(normal)) => format!(" {position}//{normal}"),
                (None, None) => format!(" {position}"),
            };
            self.scan.text.push_str(&word);
        }
        self.scan.text.push('\n');
        Ok(())
    }

    /// The numbers of a corner's position, texture coordinates and normal, from 1.
    fn corner(&self, at: &Place<'_>, word: &str) -> Result<[Option<usize>; 3], LoadError> {
        const WHAT: [&str; 3] = ["vertices", "texture coordinates", "normals"];
        let mut numbers = [None; 3];
        let shown = shorten(word);
        for (kind, text) in word.split('/').enumerate() {
            if kind > 2 || (kind == 0 && text.is_empty()) {
                return Err(at.error(
                    Some(word),
                    &format!("expected v, v/vt, v//vn or v/vt/vn, found '{shown}'"),
                ));
            }
            if text.is_empty() {
                continue;
            }
            let count = self.counts[kind];
            let Ok(index) = text.parse::<i64>() else {
                return Err(at.error(
                    Some(word),
                    &format!("expected whole numbers, found '{shown}'"),
                ));
            };
            let absolute = if index < 0 {
                count as i64 + 1 + index.max(-i64::MAX / 2)
            } else {
                index
            };
            if absolute < 1 || absolute > count as i64 {
                let what = WHAT[kind];
                return Err(at.error(
                    Some(word),
                    &format!("'{shown}' refers to number {index} of {count} {what} so far"),
                ));
            }
            numbers[kind] = Some(absolute as usize);
        }
        Ok(numbers)
    }
}

/// A line of the file, for messages.
pub(super) struct Place<'a> {
    pub(super) path: &'a Path,
    pub(super) line: &'a str,
    pub(super) number: usize,
}

impl Place<'_> {
    /// An error at `word`, which is a part of the line, or at its beginning.
    pub(super) fn error(&self, word: Option<&str>, problem: &str) -> LoadError {
        let offset = word.map_or(0, |word| {
            let start = (word.as_ptr() as usize).wrapping_sub(self.line.as_ptr() as usize);
            if start <= self.line.len() { start } else { 0 }
        });
        let before = self.line.get(..offset).unwrap_or_default();
        LoadError::Syntax {
            path: self.path.to_owned(),
            line: self.number,
            column: before.chars().count() + 1,
            problem: problem.to_owned(),
        }
    }
}
