//! `LIE-LIES`, version of the container (u32) and of the tree (u32), hash of the scene (32
//! bytes), lengths of views and tree (u64 each), BLAKE3 of all that but itself (32 bytes), views,
//! tree. Little-endian.

use std::io::{self, Read, Seek};

use lie_octree::TREE_FORMAT;
use lie_protocol::SceneHash;

use super::Refusal;

const MAGIC: [u8; 8] = *b"LIE-LIES";
/// Counts up with every change to the container or to what views mean.
const VERSION: u32 = 1;
/// Most bytes of a snapshot: more are neither written nor read.
pub(super) const LONGEST: u64 = 1 << 34;
/// What the checksum is about, of the header.
const CHECKED: usize = 8 + 4 + 4 + 32 + 8 + 8;
const HEADER: usize = CHECKED + 32;

/// What is in a container; `B` are bytes.
pub(super) struct Contents<B> {
    pub(super) scene: SceneHash,
    pub(super) views: B,
    pub(super) tree: B,
}

/// Whether a file that begins like this may be a snapshot, or was to become one.
pub(super) fn may_be_one(start: &[u8]) -> bool {
    start.starts_with(&MAGIC) || MAGIC.starts_with(start)
}

/// How long a file should be, by its header; reads on from the start afterwards.
pub(super) fn expected_length(file: &mut (impl Read + Seek)) -> io::Result<u64> {
    let mut header = vec![];
    file.by_ref().take(HEADER as u64).read_to_end(&mut header)?;
    file.rewind()?;
    Ok(lengths(&header).map_or(HEADER as u64, |[views, tree]| total(views, tree)))
}

pub(super) fn encode(contents: &Contents<Vec<u8>>) -> Vec<u8> {
    let (views, tree) = (&contents.views, &contents.tree);
    let mut out = Vec::with_capacity(HEADER + views.len() + tree.len());
    out.extend_from_slice(&MAGIC);
    out.extend_from_slice(&VERSION.to_le_bytes());
    out.extend_from_slice(&TREE_FORMAT.to_le_bytes());
    out.extend_from_slice(&contents.scene.0);
    out.extend_from_slice(&(views.len() as u64).to_le_bytes());
    out.extend_from_slice(&(tree.len() as u64).to_le_bytes());
    out.extend_from_slice(&[0; 32]);
    out.extend_from_slice(views);
    out.extend_from_slice(tree);
    let checksum = checksum(&out);
    out[CHECKED..HEADER].copy_from_slice(&checksum);
    out
}

/// The parts of a container of this scene that is whole.
pub(super) fn decode(bytes: &[u8], scene: SceneHash) -> Result<Contents<&[u8]>, Refusal> {
    if !may_be_one(bytes) {
        return Err(Refusal::Foreign);
    }
    let too_short = Refusal::Length {
        found: bytes.len() as u64,
        expected: HEADER as u64,
    };
    let [views, tree] = lengths(bytes).ok_or(too_short)?;
    if bytes[8..16] != [VERSION, TREE_FORMAT].map(u32::to_le_bytes).concat() {
        let word = |at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
        let [container, tree] = [8, 12].map(|at| u32::from_le_bytes(word(at)));
        return Err(Refusal::Format {
            found: format!("{container}.{tree}"),
            expected: format!("{VERSION}.{TREE_FORMAT}"),
        });
    }
    let (found, expected) = (bytes.len() as u64, total(views, tree));
    if found != expected {
        return Err(Refusal::Length { found, expected });
    }
    if bytes[CHECKED..HEADER] != checksum(bytes) {
        return Err(Refusal::Checksum);
    }
    if bytes[16..48] != scene.0 {
        return Err(Refusal::Scene);
    }
    // The sum is the length of what is there.
    let (views, tree) = bytes[HEADER..].split_at(views as usize);
    Ok(Contents { scene, views, tree })
}

/// Lengths of views and tree, if the header is whole.
fn lengths(bytes: &[u8]) -> Option<[u64; 2]> {
    let (views, rest) = bytes.get(48..HEADER)?.split_first_chunk()?;
    let (tree, _) = rest.split_first_chunk()?;
    Some([views, tree].map(|length| u64::from_le_bytes(*length)))
}

fn total(views: u64, tree: u64) -> u64 {
    views.saturating_add(tree).saturating_add(HEADER as u64)
}

fn checksum(bytes: &[u8]) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    hasher.update(&bytes[..CHECKED]);
    hasher.update(&bytes[HEADER..]);
    *hasher.finalize().as_bytes()
}
