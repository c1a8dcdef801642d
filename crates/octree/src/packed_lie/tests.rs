use glam::Vec3;
use lie_geom::Aabb;
use proptest::{collection::vec, prelude::*};

use super::*;
use crate::{LightEvidence, Mask, Occluder, Proof, Region, masking::Shown};

const LIGHTS: u32 = 400;
const TRIANGLES: u32 = 1 << 30;

const LIMITS: Limits = Limits {
    lights: LIGHTS,
    triangles: TRIANGLES,
};

/// Neighbours, and others.
fn triangle() -> impl Strategy<Value = u32> {
    prop_oneof![0..200u32, 0..TRIANGLES]
}

fn occluders() -> impl Strategy<Value = Vec<Occluder>> {
    let occluder = (triangle(), any::<bool>());
    vec(
        occluder.prop_map(|(triangle, own)| Occluder::new(triangle, own)),
        0..40,
    )
}

fn evidence() -> impl Strategy<Value = LightEvidence> {
    let mask = prop::sample::select(vec![None, Some(Mask::LeftOut), Some(Mask::Whole)]);
    let luminance = || prop_oneof![Just(0.0f32), 0.0..9.0f32];
    let rays = || prop_oneof![0..200u16, any::<u16>()];
    (
        (rays(), rays(), rays(), any::<u8>()),
        (any::<bool>(), any::<bool>(), mask),
        (luminance(), luminance()),
        occluders(),
    )
        .prop_map(
            |(
                (clear, blocked, agreed, importance),
                (inherited, crowded, mask),
                (most, withheld),
                occluders,
            )| {
                LightEvidence {
                    clear,
                    blocked,
                    agreed,
                    importance,
                    inherited,
                    crowded,
                    mask,
                    most,
                    withheld,
                    occluders,
                    ..LightEvidence::new(0)
                }
            },
        )
}

fn proof() -> impl Strategy<Value = Proof> {
    prop_oneof![
        Just(Proof::Unoccluded),
        Just(Proof::Hidden),
        Just(Proof::Open),
        vec(triangle(), 0..30).prop_map(|list| Proof::Behind(list.into())),
    ]
}

/// With whatever may be in a cell, each list in any order.
fn cell() -> impl Strategy<Value = Lie> {
    let lights = || prop::collection::btree_set(0..LIGHTS, 0..12);
    let region = (lights(), vec(proof(), 12)).prop_map(|(lights, proofs)| {
        let bounds = Aabb::around([Vec3::splat(-0.5), Vec3::new(1.0, 2.0, 3.0)]);
        Region::new(bounds, lights.into_iter().zip(proofs).collect())
    });
    let region = prop_oneof![Just(Region::default()), region];
    let least = prop::option::of(0.0f32..9.0);
    let counts = (any::<u32>(), any::<u32>(), any::<u64>());
    (counts, least, region, lights(), vec(evidence(), 12)).prop_map(
        |((samples, dark, version), least, region, lights, evidence)| {
            let numbered = lights.into_iter().zip(evidence);
            let lights = numbered.map(|(light, entry)| LightEvidence { light, ..entry });
            Lie {
                samples,
                dark,
                version,
                lights: lights.collect(),
                region,
                shown: Shown { least },
            }
        },
    )
}

proptest! {
    #[test]
    fn a_cell_comes_back_as_it_was(cell in cell()) {
        let packed = PackedLie::of(&cell);
        prop_assert_eq!(packed.unpack(), cell.clone());
        let mut reader = Reader(packed.as_bytes());
        prop_assert_eq!(lie(&mut reader, Some(LIMITS)), Ok(cell));
        prop_assert_eq!(reader.0.len(), 0);
        let lit = packed.unpack().lights().count() + packed.unpack().region().lit();
        prop_assert_eq!(packed.counts().entries as usize, lit);
    }

    #[test]
    fn a_part_of_its_bytes_alone_is_refused(cell in cell(), share in 0.0..1.0) {
        let packed = PackedLie::of(&cell);
        let length = (packed.as_bytes().len() as f64 * share) as usize;
        prop_assert!(lie(&mut Reader(&packed.as_bytes()[..length]), Some(LIMITS)).is_err());
    }

    #[test]
    fn what_there_is_not_is_refused(cell in cell(), lights in 0..LIGHTS, triangles in 0..300u32) {
        let packed = PackedLie::of(&cell);
        let found = lie(&mut Reader(packed.as_bytes()), Some(Limits { lights, triangles }));
        let all = |named: u32, list: &[u32]| named < lights && list.iter().all(|&it| it < triangles);
        let sampled = cell.lights.iter().all(|entry| {
            let list: Vec<u32> = entry.occluders.iter().map(|it| it.triangle()).collect();
            all(entry.light, &list)
        });
        let proven = cell.region.lights().all(|(light, proof)| match proof {
            Proof::Behind(list) => all(light, &list.iter().collect::<Vec<_>>()),
            _ => all(light, &[]),
        });
        prop_assert_eq!(found.is_ok(), sampled && proven);
    }

    /// From a file may come anything.
    #[test]
    fn whatever_bytes_are_taken_for_a_cell_are_one(
        cell in cell(), changes in vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut bytes = PackedLie::of(&cell).as_bytes().to_vec();
        for (place, byte) in changes {
            *place.get_mut(&mut bytes) = byte;
        }
        if let Ok(found) = lie(&mut Reader(&bytes), Some(LIMITS)) {
            prop_assert_eq!(PackedLie::of(&found).unpack(), found);
        }
    }
}

/// What no file may hold a scene may bring about: it must be unpacked all the same.
#[test]
fn what_is_not_a_number_comes_back() {
    let entry = LightEvidence {
        most: f32::NAN,
        withheld: f32::NEG_INFINITY,
        ..LightEvidence::new(7)
    };
    let nowhere = Aabb {
        min: Vec3::splat(f32::NAN),
        max: Vec3::splat(f32::INFINITY),
    };
    for bounds in [nowhere, Aabb::EMPTY] {
        let cell = Lie {
            lights: vec![entry.clone()],
            region: Region::new(bounds, vec![(3, Proof::Hidden)]),
            shown: Shown { least: Some(-1.0) },
            ..Lie::default()
        };
        let packed = PackedLie::of(&cell);
        assert_eq!(PackedLie::of(&packed.unpack()), packed);
        assert!(lie(&mut Reader(packed.as_bytes()), Some(LIMITS)).is_err());
    }
}

#[test]
fn a_cell_that_nothing_is_known_of_takes_next_to_nothing() {
    let packed = PackedLie::default();
    assert_eq!(packed.unpack(), Lie::default());
    assert_eq!(packed.bytes(), size_of::<PackedLie>() + 6);
}

#[test]
fn neighbours_take_a_byte_each_and_keep_their_order() {
    let triangles = [510, 500, 505, 511, 490];
    let list = triangles.map(|triangle| Occluder::new(triangle, true));
    let with = |list: &[Occluder]| {
        let entry = LightEvidence {
            occluders: list.to_vec(),
            ..LightEvidence::new(0)
        };
        PackedLie::of(&Lie {
            lights: vec![entry],
            ..Lie::default()
        })
    };
    let (one, five) = (with(&list[..1]), with(&list));
    assert_eq!(five.bytes() - one.bytes(), 4);
    assert_eq!(five.unpack().lights[0].occluders, list);
}
