//! The outer layer: the chunks of a .glb, and the bytes of all buffers.

use std::path::Path;

use gltf::json;

use super::File;
use crate::load::{LoadError, source};

/// The JSON text and the binary chunk, if any.
pub(super) struct Container<'a> {
    pub(super) json: &'a [u8],
    pub(super) binary: Option<&'a [u8]>,
}

const JSON_CHUNK: u32 = 0x4e4f_534a;
const BINARY_CHUNK: u32 = 0x004e_4942;

/// Splits a .glb into its chunks; anything else is taken for the JSON of a .gltf.
pub(super) fn split<'a>(
    file: &File<'_>,
    bytes: &'a [u8],
    warnings: &mut Vec<String>,
) -> Result<Container<'a>, LoadError> {
    if !bytes.starts_with(b"glTF") {
        return Ok(Container {
            json: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes),
            binary: None,
        });
    }
    let error = |problem: String| file.error("GLB container", problem);
    let word = |at: usize| -> Option<u32> {
        let bytes = bytes.get(at..at.checked_add(4)?)?;
        bytes.try_into().ok().map(u32::from_le_bytes)
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(error("the header is cut off: expected 12 bytes".into()));
    };
    if version != 2 {
        return Err(error(format!("version {version}: expected 2")));
    }
    let length = length as usize;
    if length > bytes.len() {
        return Err(error(format!(
            "the file is cut off: the header says {length} bytes, there are {}",
            bytes.len()
        )));
    }
    if length < bytes.len() {
        warnings.push(format!(
            "{} bytes after the end that the GLB header states are ignored",
            bytes.len() - length
        ));
    }
    let mut container = Container {
        json: &[],
        binary: None,
    };
    let mut at = 12;
    for index in 0.. {
        if at >= length {
            break;
        }
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else {
            return Err(error(format!("the header of chunk {index} is cut off")));
        };
        let end = (at + 8).saturating_add(size as usize);
        let data = bytes[..length].get(at + 8..end).ok_or_else(|| {
            error(format!(
                "chunk {index} is cut off: it states {size} bytes, {} are left",
                length.saturating_sub(at + 8)
            ))
        })?;
        match (index, kind) {
            (0, JSON_CHUNK) => container.json = data,
            (0, _) => return Err(error("the first chunk is not JSON".into())),
            (_, BINARY_CHUNK) if container.binary.is_none() => container.binary = Some(data),
            _ => warnings.push(format!("GLB chunk {index} is of no known kind and ignored")),
        }
        at = end;
    }
    if container.json.is_empty() {
        return Err(error("there is no JSON chunk".into()));
    }
    Ok(container)
}

/// The bytes of every buffer, whether anything refers to it or not.
pub(super) fn buffers(
    file: &File<'_>,
    root: &json::Root,
    binary: Option<&[u8]>,
) -> Result<Vec<Vec<u8>>, LoadError> {
    let folder = file.path.parent().unwrap_or(Path::new(""));
    let mut total = 0u64;
    let mut buffers = Vec::with_capacity(root.buffers.len());
    for (index, buffer) in root.buffers.iter().enumerate() {
        let element = || format!("buffer {index}");
        let mut bytes = match (&buffer.uri, binary) {
            (Some(uri), _) => match source::resolve(uri, folder) {
                Ok(source::Target::Data(bytes)) => bytes,
                Ok(source::Target::File(path)) => {
                    source::read(&path).map_err(|error| file.error(element(), error.to_string()))?
                }
                Err(problem) => return Err(file.error(element(), problem)),
            },
            (None, Some(binary)) if index == 0 => binary.to_vec(),
            (None, _) => return Err(file.error(element(), "it has neither a URI nor a GLB chunk")),
        };
        if bytes.starts_with(b"version https://git-lfs") {
            let problem = "expected its data, found a Git LFS pointer: fetch the file itself";
            return Err(file.error(element(), problem));
        }
        let wanted = buffer.byte_length.0;
        if (bytes.len() as u64) < wanted {
            let there = bytes.len();
            return Err(file.error(element(), format!("expected {wanted} bytes, found {there}")));
        }
        total += wanted;
        if total > source::MAX_FILE_BYTES {
            return Err(file.error(element(), "all buffers together are too long"));
        }
        bytes.truncate(wanted as usize);
        buffers.push(bytes);
    }
    Ok(buffers)
}
