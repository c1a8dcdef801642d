use glam::Vec3;

use super::*;

const SEEN: Option<u32> = None;

fn record(lie: &mut Lie, outcomes: &[(u32, Option<u32>)]) {
    let outcomes: Vec<_> = outcomes
        .iter()
        .map(|&(light, blocker)| Outcome {
            blocker,
            importance: 1.0,
            ..Outcome::of(light)
        })
        .collect();
    sample(lie, outcomes, SETTINGS);
}

const SETTINGS: LieSettings = LieSettings {
    max_depth: 0,
    split_threshold: 0,
    split_samples: 0,
    trust: 0,
    inherit: true,
    crowd: 3,
    masking: 0.0,
};

fn sample(lie: &mut Lie, outcomes: Vec<Outcome>, settings: LieSettings) {
    let seen = Observation {
        outcomes,
        ..Observation::at(Vec3::ZERO)
    };
    lie.record(std::iter::once(&seen), &settings);
}

fn standing(lie: &Lie, light: u32, trust: u32) -> &'static str {
    match lie.standing(light, trust) {
        Standing::Lit(_) => "lit",
        Standing::Hidden => "hidden",
        Standing::Certain => "certain",
        Standing::Crowded => "crowded",
        Standing::Doubtful => "doubtful",
    }
}

fn triangles(lie: &Lie, light: u32) -> Vec<(u32, bool)> {
    let occluders = &lie.evidence(light).unwrap().occluders;
    occluders
        .iter()
        .map(|known| (known.triangle(), known.is_confirmed()))
        .collect()
}

#[test]
fn the_three_cases_of_the_paper() {
    let mut lie = Lie::default();
    record(&mut lie, &[(4, Some(1))]);
    assert_eq!(lie.lights().count(), 0, "what nothing saw is not added");
    record(&mut lie, &[(4, SEEN), (2, SEEN)]);
    record(&mut lie, &[(4, Some(1))]);
    record(&mut lie, &[(4, Some(1)), (2, SEEN)]);
    let lit: Vec<u32> = lie.lights().map(|entry| entry.light).collect();
    assert_eq!(lit, [2, 4]);
    assert_eq!((lie.samples(), lie.complexity(3)), (4, 1));
    let entry = lie.evidence(4).unwrap();
    assert_eq!((entry.clear, entry.blocked), (1, 3));
    assert_eq!(triangles(&lie, 4), [(1, true)]);
}

#[test]
fn of_one_batch_what_saw_the_light_counts_first() {
    let mut lie = Lie::default();
    record(&mut lie, &[(0, Some(8)), (0, SEEN), (0, Some(9))]);
    assert_eq!(triangles(&lie, 0), [(8, true), (9, true)]);
}

#[test]
fn trust_takes_rays_that_agree_and_ends_with_one_that_does_not() {
    let mut lie = Lie::default();
    record(&mut lie, &[(0, SEEN), (1, Some(7))]);
    assert_eq!(standing(&lie, 0, 2), "doubtful");
    record(&mut lie, &[(0, SEEN), (1, Some(7))]);
    assert_eq!(standing(&lie, 0, 2), "lit");
    assert_eq!(standing(&lie, 1, 2), "hidden");
    assert_eq!(standing(&lie, 9, 3), "doubtful");
    assert_eq!(standing(&lie, 9, 0), "hidden");
    let known = lie.state(2, 2);
    assert_eq!((known.lights.len(), &known.hidden[..]), (1, &[1][..]));
    record(&mut lie, &[(0, Some(3)), (1, SEEN)]);
    assert_eq!(standing(&lie, 0, 2), "doubtful", "a new occluder");
    assert_eq!(
        standing(&lie, 1, 2),
        "doubtful",
        "it is not hidden after all"
    );
    assert_eq!(lie.hidden().count(), 0);
}

#[test]
fn a_light_that_carries_nothing_to_any_sample_is_left_out_until_it_does() {
    let mut lie = Lie::default();
    for _ in 0..15 {
        record(&mut lie, &[(1, SEEN)]);
    }
    assert_eq!(standing(&lie, 3, 16), "doubtful");
    record(&mut lie, &[(1, SEEN)]);
    assert_eq!(standing(&lie, 3, 16), "hidden");
    assert_eq!(lie.state(16, 5).hidden, [0, 2, 3, 4]);
    let mut part = lie.part(1);
    assert_eq!(
        part.state(4, 5),
        LieState::default(),
        "without samples of its own"
    );
    record(&mut part, &[]);
    assert_eq!(part.state(5, 5).hidden, [0, 2, 3, 4]);
    record(&mut lie, &[(3, SEEN)]);
    assert_eq!(standing(&lie, 3, 16), "doubtful");
    assert_eq!(lie.state(16, 5).hidden, [0, 2, 4]);
}

/// What was certain of a light was not sampled: samples that carried nothing of it say nothing.
#[test]
fn a_light_that_is_no_longer_certain_is_in_doubt() {
    let bounds = Aabb::around([Vec3::ZERO]);
    let certain = |proof| Region::new(bounds, vec![(2, proof)]);
    for proof in [Proof::Unoccluded, Proof::Hidden, Proof::Behind([7].into())] {
        let mut lie = Lie::default();
        lie.settle(certain(proof));
        for _ in 0..40 {
            record(&mut lie, &[]);
        }
        assert_eq!(standing(&lie, 2, 8), "certain");
        assert_eq!(standing(&lie, 3, 8), "hidden");
        let mut part = lie.part(1);
        for _ in 0..7 {
            record(&mut part, &[]);
        }
        let mut open = lie.clone();
        open.settle(certain(Proof::Open));
        // Of a light that has an extent nothing is said that is not certain.
        lie.settle(Region::new(bounds, vec![]));
        for lie in [lie, open, part] {
            assert_eq!(standing(&lie, 2, 8), "doubtful");
            assert!(!lie.left_out(8, 4).contains(&2));
        }
    }
}

#[test]
fn a_light_that_gives_little_needs_fewer_samples() {
    let mut lie = Lie::default();
    let outcome = |light, importance| Outcome {
        importance,
        ..Outcome::of(light)
    };
    let outcomes = vec![outcome(0, 1.0), outcome(1, 0.25), outcome(2, 0.0)];
    for _ in 0..17 {
        sample(&mut lie, outcomes.clone(), SETTINGS);
    }
    let trusted = |light| lie.standing(light, 64) != Standing::Doubtful;
    assert!(!trusted(0) && trusted(1) && trusted(2));
}

#[test]
fn too_many_occluders_are_not_listed() {
    let mut lie = Lie::default();
    record(&mut lie, &[(0, SEEN)]);
    for triangle in 0..3 {
        record(&mut lie, &[(0, Some(triangle))]);
    }
    assert_eq!(standing(&lie, 0, 0), "lit");
    record(&mut lie, &[(0, Some(3))]);
    assert_eq!(standing(&lie, 0, 0), "crowded");
    assert_eq!((lie.listed(), lie.complexity(3)), (0, 4));
    let state = lie.state(0, 10);
    assert_eq!((&state.crowded[..], state.lights.len()), (&[0][..], 0));
}

#[test]
fn a_part_keeps_what_is_known_until_it_knows_better() {
    let mut whole = Lie::default();
    record(&mut whole, &[(0, SEEN), (1, SEEN), (2, Some(5))]);
    record(&mut whole, &[(0, Some(7)), (0, Some(8))]);
    let mut part = whole.part(1);
    assert_eq!(part.state(0, 10), whole.state(0, 10));
    assert_eq!((part.samples(), part.complexity(3)), (0, 0));
    for _ in 0..LightEvidence::SETTLED {
        assert_eq!(part.state(0, 10), whole.state(0, 10));
        record(&mut part, &[(0, Some(8)), (2, Some(5))]);
    }
    // Light 0 was never seen from the part; of light 1 nothing new is known.
    let lit: Vec<u32> = part.lights().map(|entry| entry.light).collect();
    assert_eq!(lit, [1]);
    let mut part = whole.part(1);
    for _ in 0..LightEvidence::SETTLED {
        record(&mut part, &[(0, SEEN), (0, Some(8))]);
    }
    assert_eq!(triangles(&part, 0), [(8, true)]);
}

#[test]
fn what_is_certain_comes_before_what_samples_say() {
    let mut lie = Lie::default();
    for _ in 0..8 {
        record(&mut lie, &[(0, SEEN), (1, Some(7)), (2, SEEN), (4, SEEN)]);
    }
    let region = Region::new(
        Aabb::around([Vec3::ZERO, Vec3::ONE]),
        vec![
            (0, Proof::Hidden),
            (1, Proof::Unoccluded),
            (3, Proof::Behind([8, 9].into())),
            (4, Proof::Open),
        ],
    );
    lie.settle(region.clone());
    assert_eq!(lie.evidence(0), None, "it is not needed any more");
    assert_eq!(standing(&lie, 0, 2), "certain");
    assert_eq!(standing(&lie, 4, 2), "lit", "nothing was settled");
    assert_eq!(standing(&lie, 2, 8), "lit");
    assert_eq!(standing(&lie, 4, 8), "doubtful", "it takes more");
    let state = lie.state(2, 6);
    let lit: Vec<(u32, usize)> = state
        .lights
        .iter()
        .map(|lit| (lit.light, lit.occluders.len()))
        .collect();
    assert_eq!(lit, [(1, 0), (2, 0), (3, 2), (4, 0)]);
    assert_eq!(state.hidden, [0, 5]);
    assert_eq!(state.region, Some(region.bounds));
    assert_eq!(lie.complexity(3), 2);
    record(&mut lie, &[(4, SEEN)]);
    assert_eq!(lie.region().bounds, region.bounds);
    assert_eq!(lie.part(1).region(), &Region::default());
}

#[test]
fn a_cell_holds_where_it_was_seen() {
    let mut lie = Lie::default();
    for point in [Vec3::ZERO, Vec3::X] {
        let seen = Observation::at(point);
        lie.record(std::iter::once(&seen), &SETTINGS);
    }
    let bounds = Aabb::around([Vec3::ZERO, Vec3::X]);
    assert_eq!(lie.state(1, 0).region, Some(bounds));
    assert_eq!(lie.state(0, 0).region, None, "the paper's holds everywhere");
}

#[test]
fn a_part_inherits_what_may_block_its_own_rays() {
    struct Odd;
    impl Between for Odd {
        fn between(&self, light: u32, ends: Aabb) -> impl Fn(u32) -> bool {
            move |triangle| light == 0 || ends.min.x > -0.1 && triangle % 2 == 1
        }
    }
    let mut lie = Lie::default();
    let lights = [0, 1, 2].map(|light| [(light, SEEN), (light, Some(6)), (light, Some(7))]);
    record(&mut lie, lights.as_flattened());
    record(&mut lie, &[(3, Some(2)), (3, Some(4))]);
    let mut part = lie.part(1);
    part.narrow(Aabb::around([Vec3::ZERO, Vec3::ONE]), &Odd);
    assert_eq!(triangles(&part, 0), [(6, false), (7, false)]);
    assert_eq!(triangles(&part, 1), [(7, false)]);
    assert_eq!(triangles(&part, 3), [], "it stays hidden");
    assert_eq!(standing(&part, 3, 0), "hidden");
    assert_eq!(standing(&part, 2, 0), "lit");
}
