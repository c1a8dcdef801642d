//! Spoils input.

mod bytes;
mod text;

use crate::{Dice, Form, scenes::Files};

/// Longest input: more would only take time.
const LONGEST: usize = 256 * 1024;

/// One of the seeds, spoilt in one way or several. The same dice give the same.
///
/// # Panics
/// If there are no seeds.
#[must_use]
pub fn mutated(form: Form, seeds: &[Vec<u8>], dice: &mut Dice) -> Vec<u8> {
    let mut input = dice.pick(seeds).clone();
    // Most cases in one place: two wrongs may hide each other.
    let most = 1 << dice.below(4);
    let times = 1 + dice.below(most);
    for _ in 0..times {
        let other = dice.pick(seeds);
        match form {
            Form::Bytes => bytes::spoil(&mut input, other, dice),
            Form::Text => spoil_text(&mut input, other, dice),
            Form::Files => {
                let mut files = Files::split(&input);
                let others = Files::split(other);
                files.spoil(&others, dice);
                input = files.joined();
            }
        }
        input.truncate(LONGEST);
    }
    input
}

/// Tokens and lines mostly, and bytes now and then.
fn spoil_text(text: &mut Vec<u8>, other: &[u8], dice: &mut Dice) {
    if dice.one_in(4) {
        bytes::spoil(text, other, dice);
    } else {
        text::spoil(text, other, dice);
    }
}

impl Files {
    /// Spoils one of the files. `others` are files to take pieces from.
    fn spoil(&mut self, others: &Self, dice: &mut Dice) {
        if self.0.is_empty() {
            return;
        }
        let index = dice.below(self.0.len());
        let (name, content) = &mut self.0[index];
        let none = Vec::new();
        let other = others.0.iter().find(|(other, _)| other == name);
        let other = other.map_or(&none, |(_, content)| content);
        if name.ends_with(".png") || name.ends_with(".jpg") || name.ends_with(".bin") {
            bytes::spoil(content, other, dice);
        } else if content.starts_with(b"glTF") && dice.one_in(2) {
            text::spoil_within_glb(content, other, dice);
        } else if content.starts_with(b"glTF") {
            bytes::spoil(content, other, dice);
        } else {
            spoil_text(content, other, dice);
        }
    }
}
