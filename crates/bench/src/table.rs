/// A table of labels, to the left, and numbers, to the right.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    heads: Vec<String>,
    labels: usize,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows: columns of labels, then columns of numbers.
    #[must_use]
    pub fn new(labels: &[&str], numbers: &[&str]) -> Self {
        let heads = labels.iter().chain(numbers);
        Self {
            heads: heads.map(|&head| head.to_owned()).collect(),
            labels: labels.len(),
            rows: vec![],
        }
    }

    /// Adds a row. What is missing is left empty, what is too much is left out.
    pub fn push(&mut self, cells: impl IntoIterator<Item = String>) {
        let mut row: Vec<String> = cells.into_iter().collect();
        row.resize(self.heads.len(), String::new());
        self.rows.push(row);
    }

    /// For a terminal: columns two spaces apart.
    #[must_use]
    pub fn text(&self) -> String {
        let widths: Vec<usize> = (0..self.heads.len())
            .map(|column| {
                let cells = self.lines().map(|line| line[column].chars().count());
                cells.max().unwrap_or(0)
            })
            .collect();
        let mut text = String::new();
        for (index, line) in self.lines().enumerate() {
            push_line(&mut text, self.labels, line, &widths);
            if index == 0 {
                let rules: Vec<String> = widths.iter().map(|&width| "─".repeat(width)).collect();
                push_line(&mut text, self.labels, &rules, &widths);
            }
        }
        text
    }

    /// As a table of GitHub's Markdown.
    #[must_use]
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| {
            let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let rule = |column: usize| if column < self.labels { "---" } else { "---:" };
        let rules: Vec<&str> = (0..self.heads.len()).map(rule).collect();
        let mut text = line(&self.heads) + &format!("|{}|\n", rules.join("|"));
        text.extend(self.rows.iter().map(|row| line(row)));
        text
    }

    fn lines(&self) -> impl Iterator<Item = &Vec<String>> {
        std::iter::once(&self.heads).chain(&self.rows)
    }
}

fn push_line(text: &mut String, labels: usize, cells: &[String], widths: &[usize]) {
    let padded = cells
        .iter()
        .zip(widths)
        .enumerate()
        .map(|(column, (cell, &width))| {
            if column < labels {
                format!("{cell:<width$}")
            } else {
                format!("{cell:>width$}")
            }
        });
    let line = padded.collect::<Vec<_>>().join("  ");
    text.push_str(line.trim_end());
    text.push('\n');
}

/// Milliseconds, with three digits or more.
pub(crate) fn ms(value: f64) -> String {
    match value {
        v if v >= 100.0 => format!("{v:.0}"),
        v if v >= 10.0 => format!("{v:.1}"),
        v => format!("{v:.2}"),
    }
}

/// A ratio, as `2.34×`.
pub(crate) fn times(value: f64) -> String {
    format!("{value:.2}×")
}

/// A share, in per cent.
pub(crate) fn percent(value: f64) -> String {
    match 100.0 * value {
        v if v == 0.0 || v >= 1.0 || !v.is_finite() => format!("{v:.2} %"),
        v => format!("{v:.4} %"),
    }
}

/// Bytes, in thousands or millions.
pub(crate) fn memory(bytes: u64) -> String {
    match bytes as f64 {
        bytes if bytes < 1.0e6 => format!("{:.1} kB", bytes * 1.0e-3),
        bytes => format!("{:.1} MB", bytes * 1.0e-6),
    }
}

/// What there is, or a dash.
pub(crate) fn or_dash<T>(value: Option<T>, show: impl Fn(T) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), show)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new(&["scene"], &["ms", "×"]);
        table.push(["a|b".to_owned(), "1.00".to_owned(), "10".to_owned()]);
        table.push(["längere".to_owned(), "100".to_owned()]);
        table
    }

    #[test]
    fn columns_stand_under_their_heads() {
        let expected = "scene      ms   ×\n\
                        ───────  ────  ──\n\
                        a|b      1.00  10\n\
                        längere   100\n";
        assert_eq!(table().text(), expected);
        assert_eq!(Table::new(&["x"], &[]).text(), "x\n─\n");
    }

    #[test]
    fn markdown_escapes_what_would_end_a_cell() {
        let expected = "| scene | ms | × |\n|---|---:|---:|\n\
                        | a\\|b | 1.00 | 10 |\n| längere | 100 |  |\n";
        assert_eq!(table().markdown(), expected);
    }

    #[test]
    fn numbers_keep_their_digits() {
        assert_eq!(
            (ms(0.5), ms(12.34), ms(1234.5)),
            ("0.50".into(), "12.3".into(), "1234".into())
        );
        assert_eq!(percent(0.000_012), "0.0012 %");
        assert_eq!(
            (percent(0.0), percent(0.25)),
            ("0.00 %".into(), "25.00 %".into())
        );
        assert_eq!(or_dash(None, ms), "–");
    }
}
