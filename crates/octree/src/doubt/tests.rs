//! What there is to learn, against closed forms.

use glam::Vec3;

use super::*;
use crate::{LieSettings, Observation, Outcome, Proof, Region};
use lie_geom::Aabb;

const TRUST: u32 = 64;
const LIGHTS: u32 = 3;

/// A cell that was seen, with a light that reaches it: `times` rays agree on that.
fn seen(times: u32, importance: f32) -> Lie {
    let settings = LieSettings {
        trust: TRUST,
        ..LieSettings::default()
    };
    let observation = Observation {
        outcomes: vec![Outcome {
            importance,
            ..Outcome::of(1)
        }],
        ..Observation::at(Vec3::ZERO)
    };
    let mut lie = Lie::default();
    for _ in 0..times {
        lie.record(std::iter::once(&observation), &settings);
    }
    lie
}

fn settle(lie: &mut Lie, lights: &[(u32, Proof)]) {
    lie.settle(Region::new(Aabb::around([Vec3::ZERO]), lights.to_vec()));
}

fn check(lie: &Lie, trust: u32, share: f32, answered: u32) {
    let found = lie.doubt(trust, LIGHTS, |_| true);
    assert!((found.share - share).abs() < 1.0e-6, "{found:?}");
    assert_eq!(found.answered, answered);
}

#[test]
fn all_is_in_doubt_where_nothing_was_seen() {
    assert_eq!(Lie::default().doubt(TRUST, LIGHTS, |_| true), Doubt::WHOLE);
    check(&Lie::default(), 0, 1.0, 0);
}

#[test]
fn doubt_is_contribution_times_what_evidence_lacks() {
    let unseen = |samples: f32| 2.0 / 255.0 / (samples + 1.0);
    check(&seen(16, 1.0), TRUST, 0.75 + unseen(16.0), 0);
    // Half as important: half as many rays are needed.
    let half = 128.0 / 255.0;
    let lacking = 1.0 - 16.0 / (64.0 * half);
    check(&seen(16, 0.5), TRUST, half * lacking + unseen(16.0), 0);
    check(&seen(64, 1.0), TRUST, 0.0, 1);
}

#[test]
fn what_is_certain_is_not_in_doubt() {
    let mut lie = Lie::default();
    let list = Proof::Behind([7].into());
    settle(
        &mut lie,
        &[(0, Proof::Unoccluded), (1, list), (2, Proof::Hidden)],
    );
    check(&lie, TRUST, 0.0, 3);
    let mut open = seen(16, 1.0);
    settle(
        &mut open,
        &[(0, Proof::Hidden), (1, Proof::Open), (2, Proof::Hidden)],
    );
    // Four times as many rays must agree on what geometry left open.
    check(&open, TRUST, 1.0 - 16.0 / 256.0, 2);
}

#[test]
fn a_light_that_was_never_asked_is_in_doubt_for_those_who_ask_it() {
    let mut lie = seen(64, 1.0);
    settle(&mut lie, &[(0, Proof::Open), (2, Proof::Hidden)]);
    check(&lie, TRUST, 1.0 / 16.0, 2);
    let unasked = lie.doubt(TRUST, LIGHTS, |light| light != 0);
    assert_eq!(
        (unasked.share, unasked.evaluated, unasked.answered),
        (0.0, 3, 2)
    );
}

#[test]
fn in_the_papers_mode_every_cell_is_worth_a_sample() {
    check(&seen(27, 1.0), 0, 0.1, 1);
    check(&seen(3000, 1.0), 0, 3.0 / 3003.0, 1);
}
