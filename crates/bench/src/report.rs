use std::{fs, path::Path};

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
        let folder = path.with_extension("");
        let failed = |path: &Path, source| BenchError::Write {
            path: path.to_owned(),
            source,
        };
        fs::create_dir_all(&folder).map_err(|error| failed(&folder, error))?;
        for figure in self.sections.iter().flat_map(Section::all_figures) {
            let file = folder.join(&figure.name);
            match &figure.picture {
                Picture::Svg(svg) => fs::write(&file, svg).map_err(|error| failed(&file, error))?,
                Picture::Frame(film, tone_map) => write_png(&file, film, tone_map)?,
            }
        }
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        fs::write(path, self.markdown(&name)).map_err(|error| failed(path, error))
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
mod tests {
    use super::*;
    use glam::UVec2;

    fn report() -> Report {
        let mut table = Table::new(&["scene"], &["ms"]);
        table.push(["bar".to_owned(), "12".to_owned()]);
        let figure = |name: &str, picture| Figure {
            name: name.to_owned(),
            caption: "A caption.".to_owned(),
            picture,
        };
        let tone_map = ToneMap {
            exposure_stops: 0.0,
            curve: lie_render::ToneCurve::Aces,
        };
        let frame = Picture::Frame(Film::new(UVec2::splat(2)), tone_map);
        Report {
            title: "Results".to_owned(),
            command_line: "lie bench table1".to_owned(),
            machine: Machine::here(),
            sections: vec![Section {
                heading: "Times".to_owned(),
                paragraphs: vec!["Of frames.".to_owned()],
                tables: vec![table],
                figures: vec![
                    figure("plot.svg", Picture::Svg("<svg/>".to_owned())),
                    figure("bar.png", frame),
                ],
                panels: vec![Panel {
                    columns: 2,
                    figures: ["a.svg", "b.svg", "c d.svg"]
                        .map(|name| figure(name, Picture::Svg(String::new())))
                        .into(),
                }],
            }],
        }
    }

    #[test]
    fn a_report_names_its_machine_and_links_its_pictures() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.md");
        report().write(&path).unwrap();
        let text = fs::read_to_string(&path).unwrap();
        for part in [
            "# Results",
            "    lie bench table1",
            "| cores |",
            "## Times",
            "| bar | 12 |",
        ] {
            assert!(text.contains(part), "{part} in {text}");
        }
        for name in ["plot.svg", "bar.png", "a.svg", "b.svg", "c d.svg"] {
            let link = name.replace(' ', "%20");
            assert!(text.contains(&format!("](results/{link})")), "{text}");
            assert!(folder.path().join("results").join(name).exists());
        }
        let panel = "| A caption. | A caption. |\n|---|---|\n\
                     | ![A caption.](results/a.svg) | ![A caption.](results/b.svg) |\n\
                     | A caption. |  |\n| ![A caption.](results/c%20d.svg) |  |\n";
        assert!(text.contains(panel), "{text}");
    }

    #[test]
    fn what_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let blocked = folder.path().join("results");
        fs::write(&blocked, "a file").unwrap();
        let error = report()
            .write(&folder.path().join("results.md"))
            .unwrap_err();
        assert!(error.to_string().contains("results"), "{error}");
    }

    #[test]
    fn file_names_are_harmless() {
        assert_eq!(file_stem("../Café & bar"), "---caf----bar");
    }
}
