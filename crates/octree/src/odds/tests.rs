//! What may be wrong, against closed forms.

use glam::Vec3;
use lie_geom::Aabb;

use super::*;
use crate::{LieSettings, Observation, Outcome, Proof, Region, masking::Shown};

const TRUST: u32 = 16;

fn record(lie: &mut Lie, light: u32, blocker: Option<u32>, times: u32, settings: &LieSettings) {
    let seen = Observation {
        outcomes: vec![Outcome {
            blocker,
            importance: 1.0,
            luminance: if blocker.is_none() { 1.0e-3 } else { 0.0 },
            withheld: if blocker.is_some() { 1.0e-3 } else { 0.0 },
            ..Outcome::of(light)
        }],
        ..Observation::at(Vec3::ZERO)
    };
    for _ in 0..times {
        lie.record(std::iter::once(&seen), settings);
    }
}

fn settings() -> LieSettings {
    LieSettings {
        trust: TRUST,
        ..LieSettings::default()
    }
}

fn check(lie: &Lie, light: u32, trust: u32, expected: f32) {
    let found = lie.odds(light, trust).one;
    assert!(
        (found - expected).abs() < 1.0e-7,
        "light {light}: {found} is not {expected}"
    );
}

#[test]
fn what_n_rays_agree_on_is_wrong_with_1_in_n_plus_2() {
    let mut lie = Lie::default();
    record(&mut lie, 0, None, 30, &settings());
    record(&mut lie, 1, Some(7), 18, &settings());
    check(&lie, 0, TRUST, 1.0 / 32.0);
    check(&lie, 1, TRUST, 1.0 / 20.0);
    // An occluder that was not known: what agreed before counts no more, and the light is traced.
    record(&mut lie, 0, Some(9), 1, &settings());
    check(&lie, 0, TRUST, 0.0);
    check(&lie, 0, 0, 1.0 / 2.0);
    record(&mut lie, 0, None, 20, &settings());
    check(&lie, 0, TRUST, 1.0 / 22.0);
}

#[test]
fn two_rays_are_wrong_more_often_than_if_the_first_told_nothing() {
    let mut lie = Lie::default();
    record(&mut lie, 0, None, 30, &settings());
    let odds = lie.odds(0, TRUST);
    assert!((odds.two - 2.0 / (32.0 * 33.0)).abs() < 1.0e-7, "{odds:?}");
    assert!(odds.two > odds.one * odds.one && odds.two < odds.one);
}

#[test]
fn of_a_light_that_no_ray_went_to_nothing_is_known() {
    let mut lie = Lie::default();
    check(&lie, 5, TRUST, 0.0);
    check(&lie, 5, 0, 0.5);
    record(&mut lie, 0, None, 15, &settings());
    check(&lie, 5, TRUST, 0.0);
    record(&mut lie, 0, None, 1, &settings());
    check(&lie, 5, TRUST, 0.5);
}

#[test]
fn what_is_certain_doubtful_or_crowded_is_never_wrong() {
    let settings = LieSettings {
        crowd: 2,
        ..settings()
    };
    let mut lie = Lie::default();
    record(&mut lie, 0, None, 40, &settings);
    record(&mut lie, 1, None, 3, &settings);
    record(&mut lie, 2, None, 1, &settings);
    for triangle in 0..5 {
        record(&mut lie, 2, Some(triangle), 20, &settings);
    }
    assert!(matches!(lie.standing(1, TRUST), Standing::Doubtful));
    assert!(matches!(lie.standing(2, TRUST), Standing::Crowded));
    check(&lie, 1, TRUST, 0.0);
    check(&lie, 2, TRUST, 0.0);
    for proof in [Proof::Unoccluded, Proof::Hidden, Proof::Behind([3].into())] {
        let mut settled = lie.clone();
        settled.settle(Region::new(Aabb::around([Vec3::ZERO]), vec![(0, proof)]));
        check(&settled, 0, TRUST, 0.0);
    }
    // Where geometry was asked in vain, four times as many rays must agree.
    lie.settle(Region::new(
        Aabb::around([Vec3::ZERO]),
        vec![(0, Proof::Open)],
    ));
    assert_eq!(
        (lie.needed(0, TRUST), lie.needed(1, TRUST)),
        (4 * TRUST, TRUST)
    );
    check(&lie, 0, TRUST, 0.0);
    check(&lie, 0, 0, 1.0 / 42.0);
}

#[test]
fn a_mask_is_wrong_for_the_rays_that_it_was_wrong_for() {
    let settings = LieSettings {
        masking: 1.0,
        ..settings()
    };
    let mut lie = Lie::default();
    // Nine tenths of the rays are blocked, and it is outshone.
    record(&mut lie, 0, None, 4, &settings);
    record(&mut lie, 0, Some(3), 36, &settings);
    lie.shown = Shown::default();
    let bright = Observation {
        outcomes: vec![Outcome {
            importance: 1.0,
            luminance: 100.0,
            ..Outcome::of(1)
        }],
        ..Observation::at(Vec3::ZERO)
    };
    lie.record(std::iter::once(&bright), &settings);
    assert_eq!(lie.evidence(0).unwrap().mask, Some(Mask::LeftOut));
    check(&lie, 0, TRUST, 5.0 / 42.0);
}
