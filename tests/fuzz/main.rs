//! Fuzz targets: whatever the bytes are, there is an answer that keeps its own laws, or a refusal, in bounded time and
//! memory.
//!
//! ```sh
//! cargo test --test fuzz                                                         # fixed seeds, some seconds
//! BOLERO_RANDOM_TEST_TIME_MS=3600000 cargo test --release --test fuzz robot      # an hour of new ones; counts at the end
//! cargo bolero test --profile release robot::any_urdf_is_answered_or_refused     # guided by coverage: cargo-bolero, nightly
//! ```
//!
//! A failing case prints itself as the tool reads it. Each becomes a test of its own where it is mended, or one of
//! `tests/library/regression.rs`.

mod answer;
mod choices;
mod open;
mod problem;
mod robot;
mod state;
mod study;
#[path = "../support/mod.rs"]
mod support;
mod watch;

use support::random::Random;

/// The longest input \[bytes\].
const LONGEST: usize = 2048;

/// Whether bolero chooses the inputs: where one of its variables is set. Else the seeds are fixed, so that the same
/// code passes the same tests.
fn by_bolero() -> bool {
    std::env::vars().any(|(name, _)| name.contains("BOLERO"))
}

/// Checks the bytes of each seed, and that at least a `share` of them were answered.
fn check_seeds(count: u64, share: f64, check: fn(&[u8]) -> bool) {
    let answered = (0..count).filter(|&seed| {
        let mut random = Random::new(seed);
        check(&(0..LONGEST / 8).flat_map(|_| random.bits().to_le_bytes()).collect::<Vec<u8>>())
    });
    let answered = answered.count() as f64;
    assert!(answered >= share * count as f64, "only {answered} of {count} were answered");
}

/// A test that checks bytes by `$check`, which returns whether they were answered.
macro_rules! target {
    ($name:ident, $count:expr, $share:expr, $check:path) => {
        #[test]
        fn $name() {
            if crate::by_bolero() {
                bolero::check!().with_max_len(crate::LONGEST).for_each(|bytes: &[u8]| {
                    $check(bytes);
                });
            } else {
                crate::check_seeds($count, $share, $check);
            }
        }
    };
}
use target;
