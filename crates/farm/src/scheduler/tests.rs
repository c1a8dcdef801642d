use proptest::prelude::*;

use super::*;

fn at(start: Instant, ms: u64) -> Instant {
    start + Duration::from_millis(ms)
}

#[test]
fn tiles_go_out_by_credits_and_a_faster_shader_gets_more() {
    let start = Instant::now();
    let mut scheduler = Scheduler::new(0..8, LatePolicy::default());
    scheduler.joined(1, 2);
    scheduler.joined(2, 3);
    let first = scheduler.assign(start);
    assert_eq!(first.len(), 5);
    assert_eq!(scheduler.in_flight(1), 2);
    assert_eq!(scheduler.in_flight(2), 3);
    assert!(scheduler.assign(start).is_empty());
    let (_, tile) = *first.iter().find(|(shader, _)| *shader == 2).unwrap();
    assert_eq!(
        scheduler.completed(tile, 2, at(start, 5)),
        Completion::First
    );
    assert_eq!(
        scheduler.completed(tile, 2, at(start, 5)),
        Completion::Duplicate
    );
    assert_eq!(scheduler.assign(at(start, 5)), [(2, 5)]);
}

#[test]
fn a_lost_shaders_tiles_come_first_and_a_late_joiner_takes_them() {
    let start = Instant::now();
    let mut scheduler = Scheduler::new(0..6, LatePolicy::default());
    scheduler.joined(1, 2);
    assert_eq!(scheduler.assign(start), [(1, 0), (1, 1)]);
    scheduler.lost(1);
    scheduler.lost(1);
    assert_eq!(scheduler.lost_tiles(), 2);
    assert!(scheduler.assign(start).is_empty());
    scheduler.joined(2, 3);
    assert_eq!(scheduler.assign(start), [(2, 0), (2, 1), (2, 2)]);
    // A tile from a shader that was given up for lost counts for nothing.
    assert_eq!(scheduler.completed(0, 1, start), Completion::Duplicate);
    assert_eq!(scheduler.completed(0, 2, start), Completion::First);
}

#[test]
fn a_late_tile_goes_to_an_idle_shader_once() {
    let start = Instant::now();
    let mut scheduler = Scheduler::new(0..2, LatePolicy::default());
    scheduler.joined(1, 1);
    scheduler.joined(2, 1);
    assert_eq!(scheduler.assign(start), [(1, 0), (2, 1)]);
    assert_eq!(scheduler.completed(1, 2, at(start, 10)), Completion::First);
    assert!(scheduler.assign(at(start, 50)).is_empty());
    let deadline = scheduler.next_deadline().unwrap();
    assert_eq!(deadline, at(start, 100));
    assert_eq!(scheduler.assign(deadline), [(2, 0)]);
    assert_eq!(scheduler.reissued_tiles(), 1);
    assert!(scheduler.assign(at(start, 9999)).is_empty());
    assert_eq!(
        scheduler.completed(0, 2, at(start, 9999)),
        Completion::First
    );
    assert!(scheduler.is_done());
    assert_eq!(
        scheduler.completed(0, 1, at(start, 9999)),
        Completion::Duplicate
    );
}

#[test]
fn a_tile_that_is_late_at_two_shaders_goes_to_a_third() {
    let start = Instant::now();
    let mut scheduler = Scheduler::new(0..3, LatePolicy::default());
    for shader in 1..=3 {
        scheduler.joined(shader, 1);
    }
    assert_eq!(scheduler.assign(start), [(1, 0), (2, 1), (3, 2)]);
    // The first two hang.
    assert_eq!(scheduler.completed(2, 3, at(start, 10)), Completion::First);
    assert!(!scheduler.is_silent(1, at(start, 99)));
    assert!(scheduler.is_silent(1, at(start, 100)));
    assert!(!scheduler.is_silent(3, at(start, 100)));
    assert_eq!(scheduler.assign(at(start, 100)), [(3, 0)]);
    assert_eq!(scheduler.completed(0, 3, at(start, 110)), Completion::First);
    assert_eq!(scheduler.assign(at(start, 110)), [(3, 1)]);
    assert_eq!(scheduler.completed(1, 3, at(start, 120)), Completion::First);
    assert!(scheduler.is_done());

    let mut scheduler = Scheduler::new(0..1, LatePolicy::default());
    scheduler.joined(1, 1);
    scheduler.joined(2, 1);
    assert_eq!(scheduler.assign(start), [(1, 0)]);
    assert_eq!(scheduler.assign(at(start, 1000)), [(2, 0)]);
    scheduler.joined(3, 1);
    assert!(scheduler.assign(at(start, 1999)).is_empty());
    assert_eq!(scheduler.next_deadline(), Some(at(start, 2000)));
    assert_eq!(scheduler.assign(at(start, 2000)), [(3, 0)]);
    assert_eq!(
        scheduler.completed(0, 1, at(start, 2001)),
        Completion::First
    );
    // Three times the mean, which is that one's time.
    assert!(!scheduler.is_silent(1, at(start, 9000)), "it has answered");
    assert!(!scheduler.is_silent(2, at(start, 7000)));
    assert!(scheduler.is_silent(2, at(start, 1000 + 3 * 2001)));
}

#[test]
fn a_shader_in_reserve_is_asked_when_all_others_are_late() {
    let start = Instant::now();
    let mut scheduler = Scheduler::new(0..5, LatePolicy::default());
    scheduler.joined(1, 2);
    scheduler.joined(2, 1);
    scheduler.joined_in_reserve(3);
    assert_eq!(scheduler.assign(start), [(1, 0), (1, 1), (2, 2)]);
    assert!(scheduler.has_reserves());
    // One finishes, the other hangs.
    assert_eq!(scheduler.completed(2, 2, at(start, 90)), Completion::First);
    assert_eq!(scheduler.assign(at(start, 90)), [(2, 3)]);
    let late = at(start, 3 * 90);
    assert!(scheduler.assign(late).is_empty(), "the second is in time");
    // And now that one as well, while a tile waits.
    assert_eq!(scheduler.assign(at(start, 90 + 3 * 90)), [(3, 4)]);
    assert!(!scheduler.has_reserves());
    let mut now = at(start, 400);
    assert_eq!(scheduler.completed(4, 3, now), Completion::First);
    for left in (0..3).rev() {
        let given = scheduler.assign(now);
        assert!(matches!(given[..], [(3, _)]), "{given:?}");
        now += Duration::from_millis(1);
        assert_eq!(scheduler.completed(given[0].1, 3, now), Completion::First);
        assert_eq!(scheduler.unfinished(), left);
    }

    let mut scheduler = Scheduler::new(0..2, LatePolicy::default());
    scheduler.joined_in_reserve(3);
    assert_eq!(scheduler.assign(start), [(3, 0)], "there is nobody else");
}

#[test]
fn a_late_tile_whose_second_shader_dies_stays_with_the_first() {
    let start = Instant::now();
    let mut scheduler = Scheduler::new(0..1, LatePolicy::default());
    scheduler.joined(1, 1);
    scheduler.joined(2, 1);
    assert_eq!(scheduler.assign(start), [(1, 0)]);
    assert_eq!(scheduler.assign(at(start, 5000)), [(2, 0)]);
    scheduler.lost(2);
    assert!(scheduler.assign(start).is_empty());
    assert_eq!(
        scheduler.completed(0, 1, at(start, 6000)),
        Completion::First
    );
}

#[test]
fn a_late_tile_that_nobody_can_take_over_wakes_nobody() {
    let start = Instant::now();
    let mut scheduler = Scheduler::new(0..4, LatePolicy::default());
    scheduler.joined(1, 2);
    scheduler.joined(2, 2);
    assert_eq!(scheduler.assign(start).len(), 4);
    // Both are busy: a deadline that has passed would be waited for without end.
    assert_eq!(scheduler.next_deadline(), None);
    assert!(scheduler.assign(at(start, 5000)).is_empty());
    assert_eq!(scheduler.next_deadline(), None);
    let (&tile, _) = scheduler.shaders[&2].tiles.first_key_value().unwrap();
    assert_eq!(
        scheduler.completed(tile, 2, at(start, 5000)),
        Completion::First
    );
    assert!(scheduler.assign(at(start, 5000)).is_empty());
    let deadline = scheduler.next_deadline();
    assert!(deadline.is_none_or(|deadline| deadline > at(start, 5000)));
}

#[test]
fn a_tile_that_a_shader_cannot_render_goes_to_those_who_have_not_tried() {
    let start = Instant::now();
    let mut scheduler = Scheduler::new(0..3, LatePolicy::default());
    scheduler.joined(1, 1);
    scheduler.joined(2, 2);
    scheduler.joined_in_reserve(3);
    assert_eq!(scheduler.assign(start), [(2, 0), (1, 1), (2, 2)]);
    assert!(scheduler.failed(1, 1));
    assert!(
        !scheduler.failed(1, 1),
        "once for each time that it was given"
    );
    // The second is busy, and the third not relied on: it is waited for.
    assert!(scheduler.assign(start).is_empty());
    assert_eq!(scheduler.completed(0, 2, start), Completion::First);
    assert_eq!(scheduler.assign(start), [(2, 1)]);
    assert!(scheduler.failed(1, 2));
    assert_eq!(scheduler.assign(start), [(3, 1)]);
    // Nobody is left who has not tried.
    assert!(scheduler.failed(1, 3));
    assert_eq!(scheduler.assign(start), [(1, 1)]);
    scheduler.lost(1);
    assert_eq!(scheduler.assign(start), [(2, 1)]);
    // One that is late does not go to who could not render it.
    scheduler.joined(4, 2);
    assert_eq!(scheduler.assign(at(start, 5000)), [(4, 1)]);
    assert!(scheduler.failed(1, 4));
    assert_eq!(scheduler.assign(at(start, 5001)), [(4, 2)]);
    for (tile, shader) in [(2, 4), (1, 2)] {
        let completion = scheduler.completed(tile, shader, at(start, 5002));
        assert_eq!(completion, Completion::First);
    }
    assert!(!scheduler.failed(1, 2), "it is done");
    assert!(scheduler.is_done());
}

/// What may happen between two assignments.
#[derive(Clone, Copy, Debug)]
enum Event {
    Join(u32),
    Reserve(u32),
    Lose(u32),
    /// Of the tiles in flight; the first without an index.
    Complete(Option<prop::sample::Index>),
    Fail(prop::sample::Index),
    Wait(u16),
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        1 => (0u32..5).prop_map(Event::Join),
        1 => (0u32..5).prop_map(Event::Reserve),
        1 => (0u32..5).prop_map(Event::Lose),
        6 => any::<prop::sample::Index>().prop_map(|index| Event::Complete(Some(index))),
        2 => any::<prop::sample::Index>().prop_map(Event::Fail),
        2 => (0u16..2000).prop_map(Event::Wait),
    ]
}

proptest! {
    #[test]
    fn every_tile_is_done_once_whatever_is_lost(
        tiles in 0u32..40,
        events in proptest::collection::vec(event(), 0..200),
    ) {
        let credits = |shader: u32| 1 + shader as usize % 3;
        let mut now = Instant::now();
        let mut scheduler = Scheduler::new(0..tiles, LatePolicy::default());
        let mut flying: Vec<(ShaderId, u32)> = Vec::new();
        let mut done = vec![0; tiles as usize];
        // After the events one shader lives and answers everything.
        let closing = std::iter::once(Event::Join(9))
            .chain((0..5).map(Event::Lose))
            .chain(std::iter::repeat_n(Event::Complete(None), 1000));
        for event in events.into_iter().chain(closing) {
            match event {
                Event::Join(shader) => scheduler.joined(shader, credits(shader)),
                Event::Reserve(shader) if scheduler.in_flight(shader) == 0 => {
                    scheduler.lost(shader);
                    scheduler.joined_in_reserve(shader);
                }
                Event::Reserve(_) => {}
                Event::Lose(shader) => {
                    scheduler.lost(shader);
                    flying.retain(|&(holder, _)| holder != shader);
                }
                Event::Complete(index) if !flying.is_empty() => {
                    let (shader, tile) = flying.swap_remove(index.map_or(0, |index| index.index(flying.len())));
                    if scheduler.completed(tile, shader, now) == Completion::First {
                        done[tile as usize] += 1;
                    }
                }
                Event::Fail(index) if !flying.is_empty() => {
                    let (shader, tile) = flying.swap_remove(index.index(flying.len()));
                    prop_assert_eq!(scheduler.failed(tile, shader), done[tile as usize] == 0);
                }
                Event::Complete(_) | Event::Fail(_) => {}
                Event::Wait(ms) => now += Duration::from_millis(ms.into()),
            }
            flying.extend(scheduler.assign(now));
            for shader in 0..10 {
                let held = flying.iter().filter(|&&(holder, _)| holder == shader).count();
                prop_assert!(held <= credits(shader));
                prop_assert_eq!(held, scheduler.in_flight(shader));
                for tile in 0..tiles {
                    let wanted = done[tile as usize] == 0 && flying.contains(&(shader, tile));
                    prop_assert_eq!(scheduler.wants(tile, shader), wanted);
                }
            }
        }
        prop_assert!(scheduler.is_done());
        prop_assert!(done.iter().all(|&times| times == 1));
    }
}
