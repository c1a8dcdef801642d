//! PEM blocks of a text, with the lines in which they begin.

use super::Flaw;

/// A block.
pub(super) struct Block {
    /// Line of its beginning, counted from 1.
    pub(super) line: usize,
    /// What it says that it is.
    pub(super) label: String,
    /// Its content.
    pub(super) bytes: Vec<u8>,
}

/// A block whose end has not been seen.
struct Open {
    line: usize,
    label: String,
    text: String,
}

/// All blocks of a text, in order; what is between them is for people.
///
/// # Errors
/// The line and what is wrong there.
pub(super) fn blocks(text: &str) -> Result<Vec<Block>, (usize, Flaw)> {
    let mut blocks = Vec::new();
    let mut open: Option<Open> = None;
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.trim_end();
        if let Some(label) = marker(content, "-----BEGIN ") {
            if let Some(unfinished) = open {
                return Err((unfinished.line, Flaw::NoEnd(unfinished.label)));
            }
            open = Some(Open {
                line,
                label: label.to_owned(),
                text: String::new(),
            });
        }
        let Some(begun) = &mut open else {
            if marker(content, "-----END ").is_some() {
                return Err((line, Flaw::NoBegin));
            }
            continue;
        };
        begun.text.push_str(content);
        begun.text.push('\n');
        if marker(content, "-----END ").is_some()
            && let Some(whole) = open.take()
        {
            blocks.push(decode(whole)?);
        }
    }
    match open {
        Some(unfinished) => Err((unfinished.line, Flaw::NoEnd(unfinished.label))),
        None => Ok(blocks),
    }
}

fn marker<'a>(line: &'a str, start: &str) -> Option<&'a str> {
    line.strip_prefix(start)?.strip_suffix("-----")
}

fn decode(open: Open) -> Result<Block, (usize, Flaw)> {
    let Open { line, label, text } = open;
    match pem::parse(text) {
        Ok(block) => Ok(Block {
            line,
            label,
            bytes: block.into_contents(),
        }),
        Err(error) => {
            let cause = error.to_string();
            Err((line, Flaw::Encoding { label, cause }))
        }
    }
}
