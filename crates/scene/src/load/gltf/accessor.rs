//! Accessors, read with every bound checked here: the glTF crate's own readers trust them.

use gltf::accessor::{Accessor, DataType, Dimensions};

use super::Document;
use crate::load::LoadError;

/// Most elements of an accessor that has no bytes of its own (all zero).
const MAX_ZEROS: usize = 1 << 20;

/// A run of equal elements inside a buffer.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    component: DataType,
    normalized: bool,
}

impl Document<'_> {
    /// An accessor of `N` numbers per element, as floats.
    pub(super) fn floats<const N: usize>(
        &self,
        accessor: &Accessor<'_>,
        what: &str,
    ) -> Result<Vec<[f32; N]>, LoadError> {
        let element = || format!("accessor {} ({what})", accessor.index());
        let wanted = match N {
            2 => Dimensions::Vec2,
            3 => Dimensions::Vec3,
            _ => Dimensions::Vec4,
        };
        if accessor.dimensions() != wanted {
            let found = accessor.dimensions();
            return Err(self
                .file
                .error(element(), format!("expected {wanted:?}, found {found:?}")));
        }
        self.read(accessor, [0.0; N], &element, |elements, index| {
            std::array::from_fn(|lane| elements.float(index, lane))
        })
    }

    /// An accessor of vertex indices.
    pub(super) fn indices(&self, accessor: &Accessor<'_>) -> Result<Vec<u32>, LoadError> {
        let element = || format!("accessor {} (indices)", accessor.index());
        let integer = matches!(
            accessor.data_type(),
            DataType::U8 | DataType::U16 | DataType::U32
        );
        if accessor.dimensions() != Dimensions::Scalar || !integer {
            let problem = "expected unsigned scalars, found something else";
            return Err(self.file.error(element(), problem));
        }
        self.read(accessor, 0, &element, |elements, index| {
            elements.integer(index)
        })
    }

    fn read<T: Copy>(
        &self,
        accessor: &Accessor<'_>,
        zero: T,
        element: &dyn Fn() -> String,
        get: impl Fn(&Elements<'_>, usize) -> T,
    ) -> Result<Vec<T>, LoadError> {
        let count = accessor.count();
        let size = accessor.size();
        let mut values = match accessor.view() {
            Some(view) => {
                let stride = view.stride().unwrap_or(size);
                let elements = Elements {
                    bytes: self.slice(&view, accessor.offset(), count, stride, size, element)?,
                    stride,
                    component: accessor.data_type(),
                    normalized: accessor.normalized(),
                };
                (0..count).map(|index| get(&elements, index)).collect()
            }
            None if count <= MAX_ZEROS => vec![zero; count],
            None => {
                return Err(self
                    .file
                    .error(element(), "too many elements without bytes"));
            }
        };
        if let Some(sparse) = accessor.sparse() {
            let (indices, replaced) = (sparse.indices(), sparse.values());
            let count = sparse.count();
            let index_type = match indices.index_type() {
                gltf::accessor::sparse::IndexType::U8 => DataType::U8,
                gltf::accessor::sparse::IndexType::U16 => DataType::U16,
                gltf::accessor::sparse::IndexType::U32 => DataType::U32,
            };
            let index_size = index_type.size();
            let places = Elements {
                bytes: self.slice(
                    &indices.view(),
                    indices.offset(),
                    count,
                    index_size,
                    index_size,
                    element,
                )?,
                stride: index_size,
                component: index_type,
                normalized: false,
            };
            let elements = Elements {
                bytes: self.slice(
                    &replaced.view(),
                    replaced.offset(),
                    count,
                    size,
                    size,
                    element,
                )?,
                stride: size,
                component: accessor.data_type(),
                normalized: accessor.normalized(),
            };
            for index in 0..count {
                let place = places.integer(index) as usize;
                let value: &mut T = values
                    .get_mut(place)
                    .ok_or_else(|| self.file.error(element(), "a sparse index is out of range"))?;
                *value = get(&elements, index);
            }
        }
        Ok(values)
    }

    /// The bytes of `count` elements, if the view and the buffer hold them.
    fn slice(
        &self,
        view: &gltf::buffer::View<'_>,
        offset: usize,
        count: usize,
        stride: usize,
        size: usize,
        element: &dyn Fn() -> String,
    ) -> Result<&[u8], LoadError> {
        let bytes = self.view(view)?;
        if stride < size {
            let problem = format!("a stride of {stride} bytes is less than an element's {size}");
            return Err(self.file.error(element(), problem));
        }
        let length = match count {
            0 => Some(0),
            _ => (count - 1)
                .checked_mul(stride)
                .and_then(|bytes| bytes.checked_add(size)),
        };
        length
            .and_then(|length| bytes.get(offset..offset.checked_add(length)?))
            .ok_or_else(|| {
                let (view, there) = (view.index(), bytes.len());
                self.file.error(
                    element(),
                    format!(
                        "{count} elements do not fit into the {there} bytes of buffer view {view}"
                    ),
                )
            })
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, view: &gltf::buffer::View<'_>) -> Result<&[u8], LoadError> {
        let buffer = &self.buffers[view.buffer().index()];
        view.offset()
            .checked_add(view.length())
            .and_then(|end| buffer.get(view.offset()..end))
            .ok_or_else(|| {
                let there = buffer.len();
                self.file.error(
                    format!("buffer view {}", view.index()),
                    format!("expected it to end within the {there} bytes of its buffer"),
                )
            })
    }
}

impl Elements<'_> {
    /// `N` bytes of one lane of one element; in range, since `slice` has checked.
    fn lane<const N: usize>(&self, index: usize, lane: usize) -> [u8; N] {
        let start = index * self.stride + lane * N;
        let mut bytes = [0; N];
        if let Some(source) = self.bytes.get(start..start + N) {
            bytes.copy_from_slice(source);
        }
        bytes
    }

    fn float(&self, index: usize, lane: usize) -> f32 {
        let scale = |value: f32, largest: f32| {
            if self.normalized {
                (value / largest).max(-1.0)
            } else {
                value
            }
        };
        match self.component {
            DataType::F32 => f32::from_le_bytes(self.lane(index, lane)),
            DataType::I8 => scale(f32::from(i8::from_le_bytes(self.lane(index, lane))), 127.0),
            DataType::U8 => scale(f32::from(u8::from_le_bytes(self.lane(index, lane))), 255.0),
            DataType::I16 => scale(
                f32::from(i16::from_le_bytes(self.lane(index, lane))),
                32_767.0,
            ),
            DataType::U16 => scale(
                f32::from(u16::from_le_bytes(self.lane(index, lane))),
                65_535.0,
            ),
            DataType::U32 => u32::from_le_bytes(self.lane(index, lane)) as f32,
        }
    }

    fn integer(&self, index: usize) -> u32 {
        match self.component {
            DataType::U8 => u32::from(u8::from_le_bytes(self.lane(index, 0))),
            DataType::U16 => u32::from(u16::from_le_bytes(self.lane(index, 0))),
            _ => u32::from_le_bytes(self.lane(index, 0)),
        }
    }
}
