//! Clips: the boundaries between the motions of one recording.

/// A step more than this many times as long as all before it starts a new clip.
const LONGER: f64 = 10.0;

/// Tracks the time of a recording.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Clock {
    last: Option<f64>,
    longest: f64,
}

/// The step from one sample to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ClockStep {
    NewClip,
    /// The time is the same: an impact lies between the samples.
    Impact,
    /// The next sample is this much later \[s\].
    Later(f64),
}

impl Clock {
    pub fn step(&mut self, time: f64) -> ClockStep {
        let passed = self.last.map(|last| time - last);
        self.last = Some(time);
        match passed {
            Some(0.0) => ClockStep::Impact,
            Some(passed) if passed > 0.0 && (self.longest == 0.0 || passed <= LONGER * self.longest) => {
                self.longest = self.longest.max(passed);
                ClockStep::Later(passed)
            }
            _ => {
                self.longest = 0.0;
                ClockStep::NewClip
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jump_back_and_a_long_pause_begin_a_clip() {
        use ClockStep::{Impact, Later, NewClip};
        let mut clock = Clock::default();
        let steps = [0.0, 0.5, 0.5, 1.0, 0.0, 0.25, 0.5, 9.0, 10.0].map(|time| clock.step(time));
        let expected =
            [NewClip, Later(0.5), Impact, Later(0.5), NewClip, Later(0.25), Later(0.25), NewClip, Later(1.0)];
        assert_eq!(steps, expected);
    }
}
