//! Feet above gaps and beyond the ends of the ground, and feet that are in the ground.

use super::*;
use heelstrike::reductions::Reductions;

#[test]
fn over_a_gap_and_beyond_an_end_there_is_nothing() {
    let gap = [[-1.0, 0.0], [-0.1, 0.0], [-0.1 + 1e-6, -5.0], [0.1 - 1e-6, -5.0], [0.1, 0.0], [1.0, 0.0]];
    let over = impact(&point(), state([0.0; 3], FALLING, 1, &gap));
    assert!(over.contacts.is_empty());
    assert_eq!(over.analysis.unwrap().verdict, Verdict::NoContact);
    assert_eq!(over.notes.len(), 1);
    assert!(over.notes[0].contains("the lowest foot, body, is 0.1 m"), "{:?}", over.notes);
    // A sole bridges the gap: both edges carry it, which act through the sole's ends if contacts are merged.
    let bridge = |merge: bool| {
        let options = Options { reductions: Reductions { merge, ..Reductions::ALL }, ..Options::default() };
        try_impact(&sole(), options, state([0.0, 0.1, 0.0], FALLING, 1, &gap)).expect("an answer")
    };
    assert_eq!([false, true].map(|merge| bridge(merge).contacts.len()), [4, 2]);
    let beyond = impact(&sole(), state([1.1, 0.1, 0.0], FALLING, 1, &gap));
    assert_touches(&beyond, &[[[0.9, 0.0], [0.0, 1.0]], [[1.0, 0.0], [0.0, 1.0]]]);
    assert_eq!(beyond.notes, ["body reaches beyond the end of the ground's profile at x = 1.0 m: there is no ground"]);
    let above = impact(&sole(), state([1.1, 0.2, 0.0], FALLING, 1, &gap));
    assert!(above.contacts.is_empty() && above.notes.len() == 1, "{:?}", above.notes);
    let aside = impact(&sole(), state([3.0, -1.0, 0.0], FALLING, 1, &gap));
    assert!(aside.notes.iter().any(|note| note.starts_with("no foot is above the ground: ")), "{:?}", aside.notes);
}

#[test]
fn a_foot_in_the_ground_is_refused_with_its_depth() {
    let level = [0.0; 3];
    for (what, robot, [x, z], profile, expected) in [
        ("toe in the riser", sole(), [0.02, 0.1], &step(0.2, 0.5)[..], 0.02),
        ("in the tread", sole(), [-1.0, 0.05], &step(0.2, 0.5), 0.05),
        ("as a whole far below the tread", sole(), [-1.0, -0.9], &step(0.2, 0.5), 1.0),
        // The lower tread is far beneath.
        ("below the upper tread", sole(), [-1.0, -0.2], &step(0.5, -3.0), 0.3),
        ("disc, its middle above the ground", disc(), [-1.0, 0.4], &step(0.2, 0.5), 0.1),
        ("disc, its middle below the ground", disc(), [-1.0, -0.3], &step(0.2, 0.5), 0.8),
        ("a ridge pokes between free corners", sole(), [0.0, 0.1], &[[-1.0, -5.0], [0.0, 0.03], [1.0, -5.0]], 0.03),
    ] {
        let found = depth(&robot, &state([x, z, 0.0], level, 1, profile));
        assert!((found - expected).abs() < 2e-6, "{what}: {found} is not {expected}");
    }
    // A thin pillar goes right through: no corner is inside the other shape, and the shortest way out is along the box.
    let pillar = [[-1.0, -5.0], [-0.01, -5.0], [-0.009, 5.0], [0.009, 5.0], [0.01, -5.0], [1.0, -5.0]];
    let found = depth(&sole(), &state([0.0, 0.1, 0.0], level, 1, &pillar));
    assert!((0.1..0.25).contains(&found), "{found}");
}

#[test]
fn a_greater_tolerance_accepts_what_is_as_deep() {
    let text = state([0.0, 0.099, 0.0], FALLING, 0.5, &step(0.1, -0.2));
    assert!(try_impact(&sole(), Options::default(), &text).is_err());
    let wide = Options { contact_tolerance: Some(2e-3), ..Options::default() };
    let found = try_impact(&sole(), wide, &text).expect("within the tolerance");
    assert_touches(&found, &[[[-0.2, -1e-3], [0.0, 1.0]], [[0.1, -1e-3], [0.0, 1.0]]]);
    assert_close(&found.contacts.iter().map(|contact| contact.gap).collect::<Vec<_>>(), &[-1e-3; 2]);
}
