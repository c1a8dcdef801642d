//! Sections of one report that different commands write: each puts its own in its place and leaves
//! the others' as they are.

/// The section of this heading in a report's Markdown, its heading included.
pub(super) fn find<'a>(markdown: &'a str, heading: &str) -> Option<&'a str> {
    range(markdown, heading).map(|(start, end)| &markdown[start..end])
}

/// The Markdown with a section in the place of its own of that heading, or after all others.
pub(super) fn put(markdown: &str, heading: &str, section: &str) -> String {
    let (start, end) = range(markdown, heading).unwrap_or((markdown.len(), markdown.len()));
    let parts = [&markdown[..start], section, &markdown[end..]];
    let parts: Vec<&str> = parts
        .into_iter()
        .map(str::trim_end)
        .filter(|part| !part.is_empty())
        .collect();
    parts.join("\n\n") + "\n"
}

/// Where a section starts, and where the next one does or the text ends.
fn range(markdown: &str, heading: &str) -> Option<(usize, usize)> {
    let mut start = None;
    let mut at = 0;
    for line in markdown.split_inclusive('\n') {
        if let Some(found) = line.strip_prefix("## ") {
            match start {
                Some(start) => return Some((start, at)),
                None if found.trim_end() == heading => start = Some(at),
                None => {}
            }
        }
        at += line.len();
    }
    start.map(|start| (start, markdown.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPORT: &str = "# Results\n\n## A\n\nold\n\n### A, more\n\n## B\n\nlast\n";

    #[test]
    fn a_section_reaches_to_the_next() {
        assert_eq!(find(REPORT, "A"), Some("## A\n\nold\n\n### A, more\n\n"));
        assert_eq!(find(REPORT, "B"), Some("## B\n\nlast\n"));
        for none in ["", "C", "A, more", "Results"] {
            assert_eq!(find(REPORT, none), None, "{none}");
        }
    }

    #[test]
    fn a_section_takes_the_place_of_its_own_or_the_last() {
        let replaced = put(REPORT, "A", "## A\n\nnew\n");
        assert_eq!(replaced, "# Results\n\n## A\n\nnew\n\n## B\n\nlast\n");
        assert_eq!(put(&replaced, "A", "## A\n\nnew\n"), replaced);
        let added = put(REPORT, "C", "## C\n\nnew\n");
        assert_eq!(added, format!("{REPORT}\n## C\n\nnew\n"));
        assert_eq!(put("", "C", "## C\n"), "## C\n");
    }
}
