//! Where a recording is one motion, and where another begins.

/// How much longer than all before a step of one clip may be.
const LONGER: f64 = 10.0;

/// Follows the time of a recording.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Clock {
    last: Option<f64>,
    longest: f64,
}

/// From one sample to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ClockStep {
    NewClip,
    /// The time stands still: an impact lies between.
    Impact,
    /// So much later \[s\].
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
