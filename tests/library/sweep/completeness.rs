//! Nothing is missed: regions from 50 samples against every place of a dense scan.
//!
//! ```text
//!     HEELSTRIKE_STUDIES=2000 HEELSTRIKE_SCAN=20000 cargo test --release --test sweep -- --nocapture dense_scan
//! ```

use crate::support::random::Random;
use crate::sweep::studies::{Subject, study, subjects};
use heelstrike::sweep::{RESOLUTION, Region, Solver, Study, Survey, Workers};
use serde_json::Value;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

const STEPS: usize = 50;

/// What a study is worth as a test.
#[derive(Debug, Default)]
struct Tally {
    studies: usize,
    regions: usize,
    /// Regions that no sample lies in.
    thin: usize,
    thinnest: f64,
    /// Studies of which some region is refused.
    refused: usize,
    /// The longest that a survey took, and of which seed.
    slowest: (Duration, u64),
    /// Stretches of places that are in no region of their regime.
    missed: usize,
}

fn environment(name: &str, default: u64) -> u64 {
    std::env::var(name).map_or(default, |value| value.parse().expect("a whole number"))
}

fn survey(subject: &Subject, text: &str) -> Survey {
    let study = Study::from_json(text).expect("a study");
    Survey::of(&subject.model(&study), Workers { threads: 1, done: &|| () })
}

/// The region of a place, unless it is on a border.
fn region_at(regions: &[Region], at: f64, range: f64) -> Option<&Region> {
    let within = regions.iter().find(|region| at < region.to).or(regions.last())?;
    let off = 2.0 * RESOLUTION * range;
    let inner = regions.len() == 1 || (at - within.from > off && within.to - at > off);
    inner.then_some(within)
}

/// The places of a dense scan whose regime is not that of their region, as stretches.
fn compare(subject: &Subject, seed: u64, text: &Value, scan: u64, tally: &Mutex<Tally>) {
    let string = text.to_string();
    let begin = Instant::now();
    let survey = survey(subject, &string);
    let time = begin.elapsed();
    let study = Study::from_json(&string).expect("a study");
    let model = subject.model(&study);
    let mut solver = Solver::new(&model);
    let parameter = &study.parameters()[0];
    let range = parameter.range();
    let place = |k: u64| parameter.from + range * (k as f64 / scan as f64);
    let mut stretches: Vec<(u64, u64)> = Vec::new();
    for k in 0..=scan {
        let at = place(k);
        let Some(region) = region_at(&survey.regions, at, range) else { continue };
        if *solver.regime(&[at]) == *region.regime {
            continue;
        }
        match stretches.last_mut() {
            Some((_, last)) if *last + 1 == k => *last = k,
            _ => stretches.push((k, k)),
        }
    }
    // A lone place on the border itself is no region: beside it the regime is the region's again.
    stretches.retain(|&(first, last)| {
        let at = place(first);
        let mut beside = |off: f64| {
            let at = at + off * 4.0 * RESOLUTION * range;
            region_at(&survey.regions, at, range).is_none_or(|region| *solver.regime(&[at]) == *region.regime)
        };
        first != last || !(beside(-1.0) && beside(1.0))
    });
    let sampled = |region: &Region| (0..STEPS).any(|k| (region.from..=region.to).contains(&parameter.sample(k)));
    for &(first, last) in &stretches {
        println!("missed: seed {seed} of {}, {} places from {}: {text}", subject.name, last - first + 1, place(first));
    }
    let mut tally = tally.lock().expect("no thread panics here");
    tally.studies += 1;
    if tally.studies.is_multiple_of(100) {
        println!("{} studies", tally.studies);
    }
    tally.slowest = tally.slowest.max((time, seed));
    tally.regions += survey.regions.len();
    tally.refused += usize::from(survey.regions.iter().any(|region| region.refused.is_some()));
    for region in survey.regions.iter().filter(|region| !sampled(region)) {
        tally.thin += 1;
        let width = (region.to - region.from) / range;
        tally.thinnest = if tally.thinnest == 0.0 { width } else { tally.thinnest.min(width) };
    }
    tally.missed += stretches.len();
}

#[test]
fn a_dense_scan_sees_no_regime_that_the_regions_lack() {
    let studies = environment("HEELSTRIKE_STUDIES", 40);
    let first = environment("HEELSTRIKE_FIRST", 0);
    let scan = environment("HEELSTRIKE_SCAN", 1_000);
    let subjects = subjects();
    let tally = Mutex::new(Tally::default());
    let next = AtomicU64::new(first);
    let threads = environment("HEELSTRIKE_THREADS", 4);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= first + studies {
                        return;
                    }
                    let subject = &subjects[(seed % subjects.len() as u64) as usize];
                    let text = study(subject, &mut Random::new(seed), STEPS);
                    compare(subject, seed, &text, scan, &tally);
                }
            });
        }
    });
    let tally = tally.into_inner().expect("no thread panics here");
    println!(
        "{} studies, {} regions, {} that no sample lies in, the thinnest {:.1e} of its range; {} with refused \
         regions; the slowest, seed {}, took {:.1?}",
        tally.studies, tally.regions, tally.thin, tally.thinnest, tally.refused, tally.slowest.1, tally.slowest.0
    );
    assert_eq!(tally.missed, 0);
}
