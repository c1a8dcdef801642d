use std::ops::Range;

use crate::Dice;

/// What a number may become.
const NUMBERS: [&str; 24] = [
    "0",
    "-0",
    "1",
    "-1",
    "0.5",
    "1e-45",
    "1e-38",
    "1e19",
    "-1e19",
    "1e39",
    "1e308",
    "-1e308",
    "1e400",
    "nan",
    "NaN",
    "inf",
    "-inf",
    "2147483648",
    "-2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "99999999999999999999999",
];

/// What opens something: many of them are deep nesting.
const OPENERS: [&str; 6] = ["[", "{", "\"", "(", "[[", "{\"a\":"];

/// Most bytes that repetition adds.
const MOST_REPEATED: usize = 32 * 1024;

/// Spoils text in one way. `other` is something to take pieces from.
pub(super) fn spoil(text: &mut Vec<u8>, other: &[u8], dice: &mut Dice) {
    match dice.below(10) {
        0..=3 => replace_number(text, dice),
        4 => replace_token(text, other, dice),
        5 => {
            if let Some(line) = line(text, dice) {
                text.drain(line);
            }
        }
        6 => repeat_lines(text, 1, dice),
        7 => {
            let times = 1 << dice.below(8);
            repeat_lines(text, times, dice);
        }
        8 => {
            let Some(from) = line(other, dice) else {
                return;
            };
            let at = line(text, dice).map_or(0, |line| line.start);
            text.splice(at..at, other[from].iter().copied());
        }
        _ => {
            let times = 1 << dice.below(12);
            let piece = dice.pick(&OPENERS).repeat(times);
            let at = dice.below(text.len() + 1);
            text.splice(at..at, piece.into_bytes());
        }
    }
}

/// Spoils the JSON of a GLB, and makes the lengths around it fit again. What is no GLB stays.
pub(super) fn spoil_within_glb(glb: &mut Vec<u8>, other: &[u8], dice: &mut Dice) {
    let Some(json) = json_of(glb) else { return };
    let mut text = glb[json.clone()].to_vec();
    let other = json_of(other).map_or(&[][..], |json| &other[json]);
    spoil(&mut text, other, dice);
    while !text.len().is_multiple_of(4) {
        text.push(b' ');
    }
    glb[12..16].copy_from_slice(&(text.len() as u32).to_le_bytes());
    glb.splice(json, text);
    let length = glb.len() as u32;
    glb[8..12].copy_from_slice(&length.to_le_bytes());
}

/// Where the JSON of a GLB is.
fn json_of(glb: &[u8]) -> Option<Range<usize>> {
    let length = u32::from_le_bytes(*glb.get(12..16)?.first_chunk()?);
    let end = 20usize.checked_add(length as usize)?;
    (end <= glb.len()).then_some(20..end)
}

fn replace_number(text: &mut Vec<u8>, dice: &mut Dice) {
    let is_number = |token: &Range<usize>| {
        let first = text[token.start];
        first.is_ascii_digit() || first == b'-' || first == b'.'
    };
    let numbers: Vec<Range<usize>> = tokens(text).filter(is_number).collect();
    if numbers.is_empty() {
        return;
    }
    let place = dice.pick(&numbers).clone();
    let new = if dice.one_in(4) {
        text[dice.pick(&numbers).clone()].to_vec()
    } else if dice.one_in(4) {
        (dice.below(200) as i64 - 100).to_string().into_bytes()
    } else {
        dice.pick(&NUMBERS).as_bytes().to_vec()
    };
    text.splice(place, new);
}

fn replace_token(text: &mut Vec<u8>, other: &[u8], dice: &mut Dice) {
    let (here, there): (Vec<_>, Vec<_>) = (tokens(text).collect(), tokens(other).collect());
    if here.is_empty() || there.is_empty() {
        return;
    }
    let (place, piece) = (dice.pick(&here).clone(), dice.pick(&there).clone());
    text.splice(place, other[piece].iter().copied());
}

/// Repeats up to eight lines so many times, where they are or elsewhere.
fn repeat_lines(text: &mut Vec<u8>, times: usize, dice: &mut Dice) {
    let Some(first) = line(text, dice) else {
        return;
    };
    let mut end = first.end;
    for _ in 0..dice.below(8) {
        end = line_end(text, end);
    }
    // What is binary has long lines.
    let block = &text[first.start..end.min(first.start + MOST_REPEATED)];
    let block = block.repeat(times.min(MOST_REPEATED / block.len()));
    let at = if dice.one_in(2) {
        end
    } else {
        line(text, dice).map_or(0, |line| line.start)
    };
    text.splice(at..at, block);
}

/// A line with its end; a long one is cut at its commas, as JSON has none.
fn line(text: &[u8], dice: &mut Dice) -> Option<Range<usize>> {
    if text.is_empty() {
        return None;
    }
    let at = dice.below(text.len());
    let start = text[..at].iter().rposition(ends_line);
    let start = start.map_or(0, |end| end + 1);
    Some(start..line_end(text, start))
}

fn line_end(text: &[u8], start: usize) -> usize {
    let end = text[start..].iter().position(ends_line);
    end.map_or(text.len(), |end| start + end + 1)
}

fn ends_line(byte: &u8) -> bool {
    matches!(byte, b'\n' | b',')
}

/// Words and numbers: whatever holds together without spaces and brackets.
fn tokens(text: &[u8]) -> impl Iterator<Item = Range<usize>> {
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b"-+._".contains(byte);
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at + text[at..].iter().position(is_part)?;
        let length = text[start..].iter().position(|byte| !is_part(byte));
        at = length.map_or(text.len(), |length| start + length);
        Some(start..at)
    })
}
