use std::ops::Range;

use lie_accel::{BlockPart, Cutout, OccluderBlocks, PACKET, RayPacket};
use lie_geom::Triangle;

use crate::light_form::AreaForm;

/// Partially occluded lights of a cell, each with the triangles that may be in its way, packed
/// into bytes. Lights are often behind the same triangles: each triangle is named once, and a
/// list says which of them, sixteen at a time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OccluderLists {
    lights: u32,
    /// For each light the distance from the one before, the number of its parts, and each
    /// part: the block's distance from the one before, and the places in it as two bytes.
    /// Then how many triangles there are, and each one's distance from the one before. Numbers in
    /// seven bits to a byte, the lowest first.
    packed: Box<[u8]>,
}

/// A light and its list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct LightList {
    pub(crate) light: u32,
    /// How many triangles.
    pub(crate) occluders: u64,
    /// Where its parts are.
    parts: Range<usize>,
}

/// [`OccluderLists`] unpacked, with the triangles themselves. To be used again for the next
/// cell: what it has allocated stays.
#[derive(Debug, Default)]
pub(crate) struct OpenLists {
    pub(crate) lights: Vec<LightList>,
    pub(crate) blocks: OccluderBlocks,
    parts: Vec<BlockPart>,
    triangles: Vec<u32>,
    shapes: Vec<Triangle>,
}

impl OccluderLists {
    /// Packs lists of triangles' numbers. Lights must rise; a list's order and what it names
    /// twice do not count.
    #[must_use]
    pub fn new(lists: &[(u32, Vec<u32>)]) -> Self {
        if lists.is_empty() {
            return Self::default();
        }
        let mut triangles: Vec<u32> = lists.iter().flat_map(|(_, list)| list).copied().collect();
        triangles.sort_unstable();
        triangles.dedup();
        let mut packed = vec![];
        let mut before = 0;
        for (light, list) in lists {
            put(&mut packed, light - before);
            before = *light;
            put_parts(&mut packed, &parts_of(list, &triangles));
        }
        put(&mut packed, triangles.len() as u32);
        let mut before = 0;
        for triangle in triangles {
            put(&mut packed, triangle - before);
            before = triangle;
        }
        Self {
            lights: lists.len() as u32,
            packed: packed.into_boxed_slice(),
        }
    }

    /// How many lights have a list.
    #[must_use]
    pub fn len(&self) -> usize {
        self.lights as usize
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lights == 0
    }

    /// The lights in rising order, and how many triangles each one's list names.
    pub fn lights(&self) -> impl Iterator<Item = (u32, u64)> {
        let mut reader = Reader(&self.packed);
        let mut light = 0;
        (0..self.lights).map(move |_| {
            light += reader.take();
            let mut occluders = 0;
            reader.take_parts(|part| occluders += u64::from(part.places.count_ones()));
            (light, occluders)
        })
    }

    /// Heap memory in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.packed.len()
    }
}

impl OpenLists {
    /// Unpacks a cell's lists. `shapes` are all triangles of the scene; those that it does not
    /// have hit nothing.
    pub(crate) fn open(&mut self, lists: &OccluderLists, shapes: &[Triangle]) {
        const NOTHING: Triangle = Triangle {
            a: glam::Vec3::ZERO,
            b: glam::Vec3::ZERO,
            c: glam::Vec3::ZERO,
            normal: glam::Vec3::ZERO,
        };
        self.lights.clear();
        self.parts.clear();
        if lists.is_empty() {
            return;
        }
        let mut reader = Reader(&lists.packed);
        let mut light = 0;
        for _ in 0..lists.lights {
            light += reader.take();
            let first = self.parts.len();
            let mut occluders = 0;
            reader.take_parts(|part| {
                occluders += u64::from(part.places.count_ones());
                self.parts.push(part);
            });
            self.lights.push(LightList {
                light,
                occluders,
                parts: first..self.parts.len(),
            });
        }
        let mut triangle = 0u32;
        self.triangles.clear();
        self.triangles.extend((0..reader.take()).map(|_| {
            triangle = triangle.wrapping_add(reader.take());
            triangle
        }));
        // Copied first: loads from all over the scene then wait for memory together.
        let shape = |&triangle: &u32| *shapes.get(triangle as usize).unwrap_or(&NOTHING);
        self.shapes.clear();
        self.shapes.extend(self.triangles.iter().map(shape));
        self.blocks.fill(&self.triangles, &self.shapes);
    }

    /// The parts of a light's list.
    pub(crate) fn parts(&self, list: &LightList) -> &[BlockPart] {
        &self.parts[list.parts.clone()]
    }

    /// Where a light's list may be in the way to an area light: bit `i` for `origins[i]`, of those
    /// in `lanes`. From the others all of the light is clear.
    pub(crate) fn may_hide(
        &self,
        list: &LightList,
        form: AreaForm<'_>,
        origins: &[[f32; PACKET]; 3],
        lanes: u32,
    ) -> u32 {
        self.blocks
            .may_hide(self.parts(list), form.ends, origins, lanes)
    }

    /// Which rays a light's list blocks, wherever they start.
    pub(crate) fn blocked(
        &self,
        list: &LightList,
        rays: &RayPacket,
        cutout: Option<&dyn Cutout>,
    ) -> u32 {
        rays.blocked_by_parts(&self.blocks, self.parts(list), cutout)
    }
}

/// A list in parts; `triangles` are all that lists name, in order.
fn parts_of(list: &[u32], triangles: &[u32]) -> Vec<BlockPart> {
    let place = |triangle: &u32| triangles.partition_point(|known| known < triangle);
    let mut places: Vec<usize> = list.iter().map(place).collect();
    places.sort_unstable();
    let blocks = places.chunk_by(|a, b| a / PACKET == b / PACKET);
    blocks
        .map(|block| BlockPart {
            block: (block[0] / PACKET) as u32,
            places: block
                .iter()
                .fold(0, |places, place| places | 1 << (place % PACKET)),
        })
        .collect()
}

fn put(packed: &mut Vec<u8>, mut number: u32) {
    while number >= 0x80 {
        packed.push(number as u8 | 0x80);
        number >>= 7;
    }
    packed.push(number as u8);
}

fn put_parts(packed: &mut Vec<u8>, parts: &[BlockPart]) {
    put(packed, parts.len() as u32);
    let mut before = 0;
    for part in parts {
        put(packed, part.block - before);
        before = part.block;
        packed.extend(part.places.to_le_bytes());
    }
}

/// Reads what was packed; past the end there are zeros.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    #[inline]
    fn byte(&mut self) -> u8 {
        let Some((&byte, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        byte
    }

    #[inline]
    fn take(&mut self) -> u32 {
        let (mut number, mut shift) = (0, 0);
        loop {
            let byte = self.byte();
            number |= u32::from(byte & 0x7f) << shift;
            shift += 7;
            if byte < 0x80 || shift > 28 {
                return number;
            }
        }
    }

    #[inline]
    fn take_parts(&mut self, mut found: impl FnMut(BlockPart)) {
        let mut block = 0;
        for _ in 0..self.take() {
            block += self.take();
            let places = u16::from_le_bytes([self.byte(), self.byte()]);
            found(BlockPart { block, places });
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn check(lists: &[(u32, Vec<u32>)]) {
        let packed = OccluderLists::new(lists);
        assert_eq!(packed.len(), lists.len());
        assert_eq!(packed.is_empty(), lists.is_empty());
        let counts: Vec<(u32, u64)> = packed.lights().collect();
        let expected = lists
            .iter()
            .map(|(light, list)| (*light, list.len() as u64));
        assert_eq!(counts, expected.collect::<Vec<_>>());
        let mut all: Vec<u32> = lists.iter().flat_map(|(_, list)| list).copied().collect();
        all.sort_unstable();
        all.dedup();
        let mut open = OpenLists::default();
        open.open(&packed, &[]);
        assert_eq!(open.blocks.len(), all.len());
        for (found, (light, list)) in open.lights.iter().zip(lists) {
            assert_eq!((found.light, found.occluders), (*light, list.len() as u64));
            let mut named = vec![];
            for part in open.parts(found) {
                let places = (0..PACKET).filter(|place| part.places >> place & 1 == 1);
                named.extend(places.map(|place| all[PACKET * part.block as usize + place]));
            }
            let mut list = list.clone();
            list.sort_unstable();
            assert_eq!(named, list);
        }
    }

    #[test]
    fn lists_come_out_as_they_went_in() {
        check(&[]);
        check(&[(0, vec![])]);
        check(&[(3, vec![7, 0, u32::MAX]), (u32::MAX, vec![0])]);
        let many = |light: u32| (1..light % 70).map(|i| i * 7919 % 3001 * light).collect();
        let mut lists: Vec<(u32, Vec<u32>)> = (0..300).map(|light| (light, many(light))).collect();
        for (_, list) in &mut lists {
            list.sort_unstable();
            list.dedup();
        }
        check(&lists);
    }

    #[test]
    fn what_lights_share_is_named_once() {
        let occluders: Vec<u32> = (900_000..900_040).collect();
        let lists: Vec<_> = (0..50).map(|light| (light, occluders.clone())).collect();
        let bytes = OccluderLists::new(&lists).bytes();
        // Three parts of three bytes for each light.
        assert!(bytes < 50 * (2 + 9) + 40 + 4, "{bytes}");
    }

    #[test]
    fn a_triangle_that_the_scene_does_not_have_hits_nothing() {
        let shape = Triangle::new(Vec3::ZERO, Vec3::X, Vec3::Y);
        let packed = OccluderLists::new(&[(0, vec![1]), (2, vec![0, 5])]);
        let mut open = OpenLists::default();
        open.open(&packed, &[shape]);
        let through = lie_geom::Ray::new(Vec3::new(0.2, 0.2, 1.0), Vec3::NEG_Z);
        let rays = RayPacket::new(&[through]);
        let blocked = |index: usize| open.blocked(&open.lights[index], &rays, None);
        assert_eq!((blocked(0), blocked(1)), (0, 1));
    }
}
