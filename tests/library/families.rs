//! Lists of modes with many velocities: their dimension, their corners, and nothing listed twice.

use Mode::{Separate, SlideMinus, SlidePlus, Stick};
use heelstrike::impact::{Analysis, ContactProblem, ListedRejections, Mode, Verdict, analyze};
use heelstrike::{Friction, impact::Family};
use std::collections::BTreeSet;

fn analysis(problem: heelstrike::Result<ContactProblem>) -> Analysis {
    let problem = problem.unwrap();
    let analysis = analyze(&problem, ListedRejections::Everything).unwrap();
    assert!(analysis.proven && analysis.verdict == Verdict::Ambiguous, "{analysis:?}");
    let valid = analysis.modes();
    let rejected: BTreeSet<_> = analysis.rejected.iter().map(|rejection| rejection.modes.clone()).collect();
    assert!(valid.iter().all(|modes| !rejected.contains(modes)), "{analysis:?}");
    assert_eq!(valid.len() + analysis.rejected.len(), 1 << (2 * problem.contacts()), "{analysis:?}");
    analysis
}

fn outcomes(analysis: &Analysis) -> Vec<(&[Mode], Vec<[f64; 2]>)> {
    analysis.outcomes.iter().map(|outcome| (&*outcome.modes, outcome.velocity_after.clone())).collect()
}

#[test]
fn a_segment_between_two_other_lists_is_a_family() {
    // L = (a, a) on contact 0 with 0 < a < 0.4 gives it c_t = 5 a - 2 and contact 1 c_n = 4 a.
    let (masses, jacobian) = ([vec![1.0, 0.0], vec![0.0, 4.0]], [[2.0, -2.0], [0.0, 0.0], [0.0, 2.0], [2.0, 0.0]]);
    let jacobian = jacobian.map(|row| row.to_vec());
    let friction = vec![Friction::from(1.0), Friction::ZERO];
    let found = analysis(ContactProblem::from_dynamics(&masses, &jacobian, &[0.0, 1.0], friction, vec![0.0; 2]));
    let corners = [
        (&[Stick, Separate][..], vec![[0.0, 0.0], [1.6, 1.6]]),
        (&[SlideMinus, SlidePlus][..], vec![[-2.0, 0.0], [2.0, 0.0]]),
    ];
    assert_eq!(outcomes(&found), corners);
    assert_eq!(found.families, [Family { modes: vec![SlideMinus, Separate], dimension: 1, corners: vec![0, 1] }]);
}

/// Of one body (paper, section 4) at its critical friction every impulse up to 1/3 is one: c_t from 1 to 0.
#[test]
fn two_segments_span_an_area_with_edges() {
    let mut delassus = vec![0.0; 16];
    for (row, column, entry) in [(0, 0, 2.0), (0, 1, 1.0), (1, 0, 1.0), (1, 1, 2.0)] {
        delassus[4 * row + column] = entry;
        delassus[4 * (row + 2) + column + 2] = entry;
    }
    let friction = vec![Friction::from(2.0); 2];
    let found = analysis(ContactProblem::new(delassus, vec![[1.0, 0.0]; 2], friction, vec![0.0; 2]));
    let [rests, slides] = [[0.0, 0.0], [1.0, 0.0]];
    let corners = [
        (&[Stick, Stick][..], vec![rests, rests]),
        (&[Stick, SlidePlus][..], vec![rests, slides]),
        (&[SlidePlus, Stick][..], vec![slides, rests]),
        (&[SlidePlus, SlidePlus][..], vec![slides, slides]),
    ];
    assert_eq!(outcomes(&found), corners);
    let families = [
        Family { modes: vec![Stick, SlidePlus], dimension: 1, corners: vec![0, 1] },
        Family { modes: vec![SlidePlus, Stick], dimension: 1, corners: vec![0, 2] },
        Family { modes: vec![SlidePlus, SlidePlus], dimension: 2, corners: vec![0, 1, 2, 3] },
    ];
    assert_eq!(found.families, families);
}

/// A plank slides on two pairs of supports; how they share the load decides how much they brake it.
#[test]
fn ends_that_are_close_are_two() {
    // Mass and moment 1, supports at 1 below the CoG.
    let jacobian: Vec<Vec<f64>> =
        [-2.0, -1.0, 1.0, 2.0].iter().flat_map(|&x| [vec![1.0, 0.0, -1.0], vec![0.0, 1.0, x]]).collect();
    let masses: Vec<Vec<f64>> = (0..3).map(|i| (0..3).map(|j| f64::from(u8::from(i == j))).collect()).collect();
    for apart in [0.25, 1e-9, 1e-15] {
        let friction = [0.0, apart, apart, 0.0].map(|more| Friction::from(0.5 + more)).to_vec();
        let found = ContactProblem::from_dynamics(&masses, &jacobian, &[3.0, -1.0, 0.0], friction, vec![0.0; 4]);
        let found = analysis(found);
        let slides = vec![SlidePlus; 4];
        assert_eq!(found.families, [Family { modes: slides.clone(), dimension: 1, corners: vec![0, 1] }], "{apart}");
        assert!(found.outcomes.iter().all(|outcome| outcome.modes == slides && outcome.family));
        let speeds = [0, 1].map(|end: usize| found.outcomes[end].velocity_after[0][0]);
        assert!((speeds[0] - speeds[1]).abs() < 4.0 * apart, "{speeds:?}");
    }
}
