use crate::Dice;

/// Integers and floats at the edges of what they can be.
const EXTREMES: [u64; 18] = [
    0,
    1,
    0x7f,
    0x80,
    0xff,
    0x7fff,
    0xffff,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_fffe,
    0xffff_ffff,
    1 << 40,
    i64::MAX as u64,
    u64::MAX - 1,
    u64::MAX,
    // As `f32`: infinity, NaN, and the largest.
    0x7f80_0000,
    0x7fc0_0000,
    0x7f7f_ffff,
];

/// Spoils bytes in one way. `other` is something to take pieces from.
pub(super) fn spoil(bytes: &mut Vec<u8>, other: &[u8], dice: &mut Dice) {
    if bytes.is_empty() {
        bytes.extend_from_slice(&other[dice.range(other.len())]);
        return;
    }
    match dice.below(10) {
        0 => {
            let place = dice.below(bytes.len());
            bytes[place] ^= 1 << dice.below(8);
        }
        1 => {
            let place = dice.below(bytes.len());
            bytes[place] = dice.next() as u8;
        }
        2 => bytes.truncate(dice.below(bytes.len())),
        3 => drop(bytes.drain(dice.range(bytes.len()))),
        4 | 5 => overwrite_with_extreme(bytes, dice),
        6 => insert_extreme(bytes, dice),
        7 => {
            let piece = bytes[dice.range(bytes.len())].to_vec();
            insert(bytes, &piece, dice);
        }
        8 => {
            // The head of one and the tail of another.
            bytes.truncate(dice.below(bytes.len() + 1));
            bytes.extend_from_slice(&other[dice.below(other.len() + 1)..]);
        }
        _ => {
            let piece = &other[dice.range(other.len())];
            let start = dice.below(bytes.len());
            for (place, byte) in bytes[start..].iter_mut().zip(piece) {
                *place = *byte;
            }
        }
    }
}

fn insert(bytes: &mut Vec<u8>, piece: &[u8], dice: &mut Dice) {
    let place = dice.below(bytes.len() + 1);
    bytes.splice(place..place, piece.iter().copied());
}

/// A little-endian integer of 1, 2, 4 or 8 bytes, wherever it is.
fn overwrite_with_extreme(bytes: &mut [u8], dice: &mut Dice) {
    let extreme = dice.pick(&EXTREMES).to_le_bytes();
    let width = 1 << dice.below(4);
    let start = dice.below(bytes.len());
    for (place, byte) in bytes[start..].iter_mut().zip(&extreme[..width]) {
        *place = *byte;
    }
}

/// An integer as bincode or LEB128 have it: longer than the one that was there.
fn insert_extreme(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let extreme = *dice.pick(&EXTREMES);
    let mut piece = Vec::new();
    match dice.below(4) {
        0 => piece.extend([&[251][..], &(extreme as u16).to_le_bytes()].concat()),
        1 => piece.extend([&[252][..], &(extreme as u32).to_le_bytes()].concat()),
        2 => piece.extend([&[253][..], &extreme.to_le_bytes()].concat()),
        _ => {
            let mut rest = extreme;
            while rest >= 0x80 {
                piece.push(rest as u8 | 0x80);
                rest >>= 7;
            }
            piece.push(rest as u8);
        }
    }
    let place = dice.below(bytes.len());
    bytes.splice(place..=place, piece);
}
