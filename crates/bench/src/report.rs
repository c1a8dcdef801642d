mod kept;

use std::{
    fs, io,
    path::{Path, PathBuf},
};

use lie_render::{Film, ToneMap, write_png};

use crate::{BenchError, Machine, Stage, Table};

/// What is written about some measurements: Markdown, with its pictures in a folder of its
/// own beside it.
pub struct Report {
    /// The heading.
    pub title: String,
    /// What was typed to get it.
    pub command_line: String,
    /// Where it was measured.
    pub machine: Machine,
    /// What was measured.
    pub sections: Vec<Section>,
}

/// A part of a report.
#[derive(Default)]
pub struct Section {
    /// Its heading.
    pub heading: String,
    /// What there is to know, in Markdown.
    pub paragraphs: Vec<String>,
    /// The figures.
    pub tables: Vec<Table>,
    /// Pictures that are seen together.
    pub panels: Vec<Panel>,
    /// The other pictures.
    pub figures: Vec<Figure>,
}

/// Pictures beside each other.
#[derive(Clone)]
pub struct Panel {
    /// How many in a row; at least one.
    pub columns: usize,
    /// Row by row.
    pub figures: Vec<Figure>,
}

/// A picture of a report.
#[derive(Clone)]
pub struct Figure {
    /// Its file's name.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// What is in the file.
    pub picture: Picture,
}

/// What a [`Figure`] is a picture of.
#[derive(Clone)]
pub enum Picture {
    /// A plot.
    Svg(String),
    /// A frame, and how it is shown; written as PNG.
    Frame(Film, ToneMap),
}

impl Report {
    /// Writes the Markdown to `path`, and the pictures into the folder of that name without
    /// its ending.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), BenchError> {
        self.rewrite(path, &[])
    }

    /// The same, but what the file has under the headings `keep` stays, after everything else.
    ///
    /// # Errors
    /// If a file cannot be written, or read.
    pub fn rewrite(&self, path: &Path, keep: &[&str]) -> Result<(), BenchError> {
        let before = if keep.is_empty() {
            String::new()
        } else {
            read(path)?
        };
        let folder = write_figures(path, self.sections.iter().flat_map(Section::all_figures))?;
        let mut text = self.markdown(&folder);
        for heading in keep {
            if let Some(section) = kept::find(&before, heading) {
                text = kept::put(&text, heading, section);
            }
        }
        write(path, &text)
    }

    /// The text; `folder` is where the pictures are, seen from it.
    #[must_use]
    pub fn markdown(&self, folder: &str) -> String {
        let mut machine = Table::new(&["", ""], &[]);
        for (name, value) in self.machine.facts() {
            machine.push([name.to_owned(), value]);
        }
        let head = format!(
            "# {}\n\nMeasured by\n\n    {}\n\n{}",
            self.title,
            self.command_line,
            machine.markdown()
        );
        let sections = self.sections.iter().map(|section| section.markdown(folder));
        std::iter::once(head)
            .chain(sections)
            .collect::<Vec<_>>()
            .join("\n")
    }
}

impl Figure {
    /// A frame of this view.
    #[must_use]
    pub fn of_frame(stage: &Stage, film: Film) -> Self {
        Self {
            name: format!("{}.png", file_stem(stage.name())),
            caption: format!("{}, camera {}", stage.name(), stage.camera().name),
            picture: Picture::Frame(film, stage.tone_map()),
        }
    }
}

impl Figure {
    fn link(&self, folder: &str) -> String {
        let (name, caption) = (&self.name, &self.caption);
        let link = format!("{folder}/{name}").replace(' ', "%20");
        format!("![{caption}]({link})")
    }
}

impl Panel {
    /// A table without numbers: captions, and the pictures below them. The first captions
    /// are its head.
    fn markdown(&self, folder: &str) -> String {
        let columns = self.columns.max(1);
        let line = |cells: Vec<String>| {
            let mut cells: Vec<String> =
                cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
            cells.resize(columns, String::new());
            format!("| {} |\n", cells.join(" | "))
        };
        let mut text = String::new();
        for (index, row) in self.figures.chunks(columns).enumerate() {
            text += &line(row.iter().map(|figure| figure.caption.clone()).collect());
            if index == 0 {
                text += &format!("|{}|\n", vec!["---"; columns].join("|"));
            }
            text += &line(row.iter().map(|figure| figure.link(folder)).collect());
        }
        text
    }
}

impl Section {
    /// Puts the section into the report at `path`, in the place of its own of that heading or after
    /// all others, and its pictures into the report's folder.
    ///
    /// # Errors
    /// If the report cannot be read, or something not written.
    pub fn put_into(&self, path: &Path) -> Result<(), BenchError> {
        let before = read(path)?;
        let folder = write_figures(path, self.all_figures())?;
        let section = self.markdown(&folder);
        write(path, &kept::put(&before, &self.heading, &section))
    }

    fn markdown(&self, folder: &str) -> String {
        let mut parts = vec![format!("## {}\n", self.heading)];
        parts.extend(self.paragraphs.iter().map(|text| format!("{text}\n")));
        parts.extend(self.tables.iter().map(Table::markdown));
        parts.extend(self.panels.iter().map(|panel| panel.markdown(folder)));
        parts.extend(self.figures.iter().map(|figure| {
            let link = figure.link(folder);
            format!("{link}\n\n*{}*\n", figure.caption)
        }));
        parts.join("\n")
    }

    fn all_figures(&self) -> impl Iterator<Item = &Figure> {
        let in_panels = self.panels.iter().flat_map(|panel| &panel.figures);
        in_panels.chain(&self.figures)
    }
}

/// Writes pictures into the folder of a report, and says its name.
fn write_figures<'a>(
    report: &Path,
    figures: impl Iterator<Item = &'a Figure>,
) -> Result<String, BenchError> {
    let folder = report.with_extension("");
    fs::create_dir_all(&folder).map_err(|error| failed(&folder, error))?;
    for figure in figures {
        let file = folder.join(&figure.name);
        match &figure.picture {
            Picture::Svg(svg) => write(&file, svg)?,
            Picture::Frame(film, tone_map) => write_png(&file, film, tone_map)?,
        }
    }
    let name = folder.file_name().unwrap_or_default();
    Ok(name.to_string_lossy().into_owned())
}

/// What is in a file; nothing if it is not there.
fn read(path: &Path) -> Result<String, BenchError> {
    match fs::read_to_string(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(String::new()),
        read => read.map_err(|source| BenchError::Read {
            path: PathBuf::from(path),
            source,
        }),
    }
}

fn write(path: &Path, text: &str) -> Result<(), BenchError> {
    fs::write(path, text).map_err(|error| failed(path, error))
}

fn failed(path: &Path, source: io::Error) -> BenchError {
    BenchError::Write {
        path: path.to_owned(),
        source,
    }
}

/// A name of letters, digits and hyphens: what a scene's name becomes in a file's.
pub(crate) fn file_stem(name: &str) -> String {
    let safe = |c: char| {
        if c.is_ascii_alphanumeric() {
            c.to_ascii_lowercase()
        } else {
            '-'
        }
    };
    name.chars().map(safe).collect()
}

#[cfg(test)]
mod tests;
