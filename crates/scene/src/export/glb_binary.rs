//! The container: a JSON chunk, and a binary one with what it refers to.

use glam::Vec3;
use serde_json::{Value, json};

use super::ExportError;

/// The binary chunk, with the views and accessors into it.
#[derive(Default)]
pub(super) struct Glb {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

impl Glb {
    /// Adds bytes as a view, at a multiple of four, and gives its index.
    pub(super) fn add_view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(json!({
            "buffer": 0,
            "byteOffset": self.bytes.len(),
            "byteLength": bytes.len(),
        }));
        self.bytes.extend_from_slice(bytes);
        self.views.len() - 1
    }

    /// Adds numbers as an accessor of a glTF type, and gives its index.
    pub(super) fn add_floats(
        &mut self,
        kind: &str,
        count: usize,
        numbers: impl Iterator<Item = f32>,
    ) -> usize {
        let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
        let view = self.add_view(&bytes);
        self.accessors.push(json!({
            "bufferView": view, "componentType": FLOAT, "count": count, "type": kind,
        }));
        self.accessors.len() - 1
    }

    /// Adds places with their bounds, and gives the accessor's index.
    pub(super) fn add_positions(&mut self, positions: &[Vec3]) -> usize {
        let numbers = positions.iter().flat_map(|position| position.to_array());
        let accessor = self.add_floats("VEC3", positions.len(), numbers);
        let bounds = lie_geom::Aabb::around(positions.iter().copied());
        self.accessors[accessor]["min"] = json!(bounds.min.to_array());
        self.accessors[accessor]["max"] = json!(bounds.max.to_array());
        accessor
    }

    /// Adds triangles' corners, and gives the accessor's index.
    pub(super) fn add_indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices
            .iter()
            .flat_map(|index| index.to_le_bytes())
            .collect();
        let view = self.add_view(&bytes);
        self.accessors.push(json!({
            "bufferView": view, "componentType": UNSIGNED_INT, "count": indices.len(), "type": "SCALAR",
        }));
        self.accessors.len() - 1
    }

    /// The file: header, JSON chunk padded with spaces, binary chunk padded with zeros.
    pub(super) fn finish(mut self, mut document: Value) -> Result<Vec<u8>, ExportError> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        if !self.bytes.is_empty() {
            document["buffers"] = json!([{"byteLength": self.bytes.len()}]);
            document["bufferViews"] = Value::Array(self.views);
            document["accessors"] = Value::Array(self.accessors);
        }
        let mut text = serde_json::to_vec(&document)?;
        text.resize(text.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + text.len() as u64 + 8 + self.bytes.len() as u64;
        let length = u32::try_from(total).map_err(|_| ExportError::TooLarge(total))?;
        let mut file = Vec::with_capacity(total as usize);
        file.extend_from_slice(b"glTF");
        file.extend_from_slice(&2u32.to_le_bytes());
        file.extend_from_slice(&length.to_le_bytes());
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.bytes)] {
            file.extend_from_slice(&(chunk.len() as u32).to_le_bytes());
            file.extend_from_slice(kind);
            file.extend_from_slice(chunk);
        }
        Ok(file)
    }
}
