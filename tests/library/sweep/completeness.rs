//! Completeness: regions found from 50 samples, compared with every place of a dense scan.
//!
//! ```text
//!     HEELSTRIKE_STUDIES=2000 HEELSTRIKE_SCAN=20000 cargo test --release --test library -- --nocapture dense_scan
//! ```

use crate::support::parallel::total;
use crate::support::random::Random;
use crate::support::subject::Subject;
use crate::sweep::studies::{study, subjects};
use heelstrike::sweep::{RESOLUTION, Region, Solver, Study, Survey, Workers};

const STEPS: usize = 50;

fn environment(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |value| value.parse().expect("a whole number"))
}

/// The region of a place; `None` if the place is on a border.
fn region_at(regions: &[Region], at: f64, range: f64) -> Option<&Region> {
    let within = regions.iter().find(|region| at < region.to).or(regions.last())?;
    let off = 2.0 * RESOLUTION * range;
    let inner = regions.len() == 1 || (at - within.from > off && within.to - at > off);
    inner.then_some(within)
}

/// Counts of a random study: its regions, those without a sample, 1 if a region is refused, and stretches of the dense
/// scan whose regime is not that of their region.
fn compare(subject: &Subject, seed: u64, scan: u64) -> [u64; 4] {
    let text = study(subject, &mut Random::new(seed), STEPS).to_string();
    let study = Study::from_json(&text).expect("a study");
    let model = subject.model(&study);
    let regions = Survey::of(&model, Workers { threads: 1, done: &|| () }).regions;
    let mut solver = Solver::new(&model);
    let parameter = &study.parameters()[0];
    let range = parameter.range();
    let place = |k: u64| parameter.from + range * (k as f64 / scan as f64);
    let mut differs =
        |at: f64| region_at(&regions, at, range).is_some_and(|region| *solver.regime(&[at]) != *region.regime);
    let mut stretches: Vec<(u64, u64)> = Vec::new();
    for k in (0..=scan).filter(|&k| differs(place(k))) {
        match stretches.last_mut() {
            Some((_, last)) if *last + 1 == k => *last = k,
            _ => stretches.push((k, k)),
        }
    }
    // A single place on a border is no region: next to it the regime is the region's again.
    let near = 4.0 * RESOLUTION * range;
    stretches.retain(|&(first, last)| first != last || differs(place(first) - near) || differs(place(first) + near));
    for &(first, last) in &stretches {
        println!("missed: seed {seed} of {}, {} places from {}: {text}", subject.name, last - first + 1, place(first));
    }
    let sampled = |region: &&Region| (0..STEPS).any(|k| (region.from..=region.to).contains(&parameter.sample(k)));
    let refused = regions.iter().any(|region| region.refused.is_some());
    let thin = regions.len() - regions.iter().filter(sampled).count();
    [regions.len() as u64, thin as u64, u64::from(refused), stretches.len() as u64]
}

#[test]
fn a_dense_scan_sees_no_regime_that_the_regions_lack() {
    let [studies, scan] =
        [("HEELSTRIKE_STUDIES", 40), ("HEELSTRIKE_SCAN", 1_000)].map(|(name, most)| environment(name, most));
    let subjects = subjects();
    let [regions, thin, refused, missed] =
        total(studies, |seed| compare(&subjects[seed as usize % subjects.len()], seed, scan));
    println!("{studies} studies, {regions} regions, {thin} that no sample lies in; {refused} with refused regions");
    assert_eq!(missed, 0);
}
