//! States whose numbers are known to an interval each: does the verdict hold on the whole box?

#[path = "../oracle/random.rs"]
#[expect(dead_code, reason = "the exact oracle needs more of it")]
mod random;
mod states;

use heelstrike::uncertain::Holds;
use random::Random;
use states::{between, impact, in_the_box, modes, on_both_feet, ramone};

#[test]
fn few_random_states_stay_unknown_and_what_is_told_is_true() {
    let robot = ramone();
    let states: usize = std::env::var("STATES").map_or(300, |text| text.parse().expect("a number"));
    let width: f64 = std::env::var("WIDTH").map_or(1e-3, |text| text.parse().expect("a number"));
    let [mut holds, mut differs, mut unknown] = [0; 3];
    let mut slowest = std::time::Duration::ZERO;
    let mut all = Vec::new();
    for seed in 0..states as u64 {
        let mut random = Random::new(seed);
        let state = on_both_feet(&robot, &mut random, width);
        let before = std::time::Instant::now();
        let answer = impact(&robot, &state);
        all.push(before.elapsed());
        slowest = slowest.max(before.elapsed());
        match answer.holds.clone().expect("the state is uncertain") {
            Holds::Everywhere => {
                holds += 1;
                for _ in 0..20 {
                    let corner = in_the_box(&robot, &state, || if random.once_in(2) { 1.0 } else { -1.0 });
                    assert_eq!(modes(&impact(&robot, &corner)), modes(&answer), "seed {seed}: {corner:?}");
                    let within = in_the_box(&robot, &state, || between(&mut random, -1.0, 1.0));
                    assert_eq!(modes(&impact(&robot, &within)), modes(&answer), "seed {seed}: {within:?}");
                }
            }
            Holds::Not(found) => {
                differs += 1;
                let other = impact(&robot, &found.state);
                assert_ne!(modes(&other), modes(&answer), "seed {seed}");
            }
            Holds::Unknown => unknown += 1,
        }
    }
    all.sort();
    eprintln!(
        "{holds} {differs} {unknown}; median {:?} 99% {:?} slowest {slowest:?}",
        all[states / 2],
        all[states * 99 / 100]
    );
    assert!(unknown * 10 <= states, "{holds} hold, {differs} do not, {unknown} unknown");
}
