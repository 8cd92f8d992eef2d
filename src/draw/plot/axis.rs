//! Axes: their ranges, ticks and labels.

use super::{Pixel, PlotPoint};
use std::f64::consts::PI;

#[derive(Debug, Clone, Default)]
pub struct PlotAxis {
    /// The quantity, with its unit.
    pub label: String,
    /// Whether the scale is logarithmic. If so, values that are not positive are not drawn.
    pub logarithmic: bool,
    /// The ends of the axis; a logarithmic axis moves them outward to whole powers of ten. `None` to span all values.
    pub range: Option<(f64, f64)>,
    /// Limits for an axis without a range: values beyond them do not widen it.
    pub within: Option<(f64, f64)>,
    /// Whether ticks and label are omitted, for instance because a neighboring panel has the same axis.
    pub bare: bool,
    /// Whether the values are angles \[rad\], with ticks at multiples of pi / 2.
    pub in_pi: bool,
}

impl PlotAxis {
    pub fn new(label: impl Into<String>) -> Self {
        Self { label: label.into(), ..Self::default() }
    }
}

/// The range of an axis, in the numbers at its ticks: exponents, multiples of pi, or multiples of a power of ten.
#[derive(Debug, Clone)]
pub(super) struct Span {
    low: f64,
    high: f64,
    /// The distance between ticks.
    step: f64,
    logarithmic: bool,
    in_pi: bool,
    /// A value is the `offset` plus the number at its tick times ten to the `power`.
    offset: f64,
    power: i32,
    /// The length on the screen \[px\].
    pub length: f64,
}

#[derive(Debug)]
pub(super) struct Tick {
    /// The place of the tick: 0 at the beginning of the axis, 1 at its end.
    pub share: f64,
    pub text: String,
}

/// Both axes of a panel on the screen.
#[derive(Debug)]
pub(super) struct PlotArea {
    pub x: Span,
    pub y: Span,
}

impl PlotArea {
    pub fn size(&self) -> Pixel {
        (self.x.length, self.y.length)
    }

    /// Returns the place of a point, from the upper left corner of the axes; `None` if it has no place on them.
    pub fn place(&self, (x, y): PlotPoint) -> Option<Pixel> {
        let at = (self.x.length * self.x.share(x), self.y.length * (1.0 - self.y.share(y)));
        (at.0.is_finite() && at.1.is_finite()).then_some(at)
    }
}

/// The room beyond the values at each end, as a share of their range.
const ROOM: f64 = 0.04;
/// The room beyond the values at each end of a logarithmic axis, as a share of their range in exponents.
const MARK: f64 = 0.02;
/// Values with a smaller relative difference count as equal.
const ROUNDING: f64 = 1e-10;
/// The approximate distance between ticks \[px\], and the number of parts into which ticks divide a short axis.
const PITCH: f64 = 75.0;
const PARTS: f64 = 4.0;
/// An axis whose distance from zero exceeds its length by this factor counts from a round number, so that its ticks
/// have few digits.
const FAR: f64 = 1e5;

/// Returns the least and the greatest value; `None` if there are no values.
pub fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.map(|value| (value, value)).reduce(|(low, high), (least, most)| (low.min(least), high.max(most)))
}

impl Span {
    /// Computes the range of an axis of this `length` \[px\] for `values`.
    pub fn new(axis: &PlotAxis, values: impl Iterator<Item = f64>, length: f64) -> Self {
        let usable = values.filter(|value| value.is_finite() && (!axis.logarithmic || *value > 0.0));
        let (lowest, highest) = axis.within.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        let spanned = axis.range.or_else(|| range(usable.map(|value| value.max(lowest).min(highest))));
        let (least, most) = spanned.filter(|(least, most)| least <= most).unwrap_or((1.0, 1.0));
        if axis.logarithmic {
            return Self::of_powers(libm::log10(least), libm::log10(most), length);
        }
        let room = if axis.range.is_some() { 0.0 } else { ROOM * (most - least) };
        let (mut low, mut high) = (least - room, most + room);
        // Values that differ only by rounding count as one value.
        let same = axis.range.is_none() && most - least <= ROUNDING * least.abs().max(most.abs());
        if low >= high || same {
            let room = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
            (low, high) = (low - room, high + room);
        }
        let round = 100.0 * libm::pow(10.0, libm::ceil(libm::log10(high - low)));
        let is_far = !axis.in_pi && low.abs().max(high.abs()) > FAR * (high - low);
        let offset = if is_far { significant((low / round).floor() * round, 15) } else { 0.0 };
        let largest = (low - offset).abs().max((high - offset).abs());
        let is_plain = axis.in_pi || (1e-2..1e5).contains(&largest);
        let power = if is_plain { 0 } else { libm::floor(libm::log10(largest)) as i32 };
        let mut span = Self { low, high, step: 1.0, logarithmic: false, in_pi: axis.in_pi, offset, power, length };
        (span.low, span.high) = (span.shown(low), span.shown(high));
        span.extend(0.0, 0.0);
        span
    }

    /// Computes the range of a logarithmic axis from the least and the greatest exponent.
    fn of_powers(least: f64, most: f64, length: f64) -> Self {
        // The room keeps marks off the edge of the panel.
        let room = MARK * (most - least);
        let low = (least - room).floor();
        let high = (most + room).ceil().max(low + 1.0);
        let step = match high - low {
            span if span <= 8.0 => 1.0,
            span if span <= 16.0 => 2.0,
            span => (span / 40.0).ceil() * 5.0,
        };
        let (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
        Self { low, high, step, logarithmic: true, in_pi: false, offset: 0.0, power: 0, length }
    }

    /// Returns the number that a tick at this value shows.
    fn shown(&self, value: f64) -> f64 {
        self.scaled(value - self.offset)
    }

    fn scaled(&self, value: f64) -> f64 {
        match self.power {
            _ if self.logarithmic => libm::log10(value),
            _ if self.in_pi => value / PI,
            0 => value,
            power if power < -300 => value * 1e300 * libm::pow(10.0, f64::from(-power - 300)),
            power => value * libm::pow(10.0, f64::from(-power)),
        }
    }

    pub fn ends(&self) -> (f64, f64) {
        let value = |shown: f64| match self.power {
            _ if self.logarithmic => libm::pow(10.0, shown),
            _ if self.in_pi => shown * PI,
            power => self.offset + shown * libm::pow(10.0, f64::from(power)),
        };
        (value(self.low), value(self.high))
    }

    /// Returns the place of a value: 0 at the beginning of the axis, 1 at its end; not finite if it has no place on it.
    pub fn share(&self, value: f64) -> f64 {
        (self.shown(value) - self.low) / (self.high - self.low)
    }

    /// Returns the length of one unit \[px\].
    pub fn scale(&self) -> f64 {
        // Without `share`: far from zero, the places of 0 and 1 would round to the same number.
        self.length * ((self.scaled(1.0) - self.scaled(0.0)) / (self.high - self.low))
    }

    /// Multiplies the range by `factor` about its middle.
    pub fn widen(&mut self, factor: f64) {
        let more = 0.5 * (factor - 1.0) * (self.high - self.low);
        self.extend(more, more);
    }

    /// Leaves `room` \[px\] free at the end of the axis.
    pub fn leave(&mut self, room: f64) {
        self.extend(0.0, (self.high - self.low) * room / (self.length - room));
    }

    fn extend(&mut self, below: f64, above: f64) {
        (self.low, self.high) = (self.low - below, self.high + above);
        if !self.logarithmic {
            let least = (self.high - self.low) * PITCH.min(self.length / PARTS) / self.length;
            // In units of pi: multiples of pi / 2, or of pi.
            self.step = if self.in_pi && least <= 0.5 { 0.5 } else { step(least) };
            if self.ticks().nth(1).is_none() {
                // A single tick would not show the scale.
                self.step = step(0.4 * self.step);
            }
        }
    }

    pub fn ticks(&self) -> impl Iterator<Item = Tick> {
        let first = (self.low / self.step - ROUNDING).ceil() as i64;
        let last = (self.high / self.step + ROUNDING).floor() as i64;
        (first..=last).map(|count| {
            let at = count as f64 * self.step;
            Tick { share: (at - self.low) / (self.high - self.low), text: self.text(at) }
        })
    }

    fn text(&self, at: f64) -> String {
        match (self.logarithmic, self.in_pi) {
            (true, _) => power_of_ten(at),
            (_, true) => multiple_of_pi(at),
            _ => fixed(at, (-libm::floor(libm::log10(self.step) + 1e-9)).clamp(0.0, 17.0) as usize),
        }
    }

    /// Returns the label with what the ticks omit: the offset after its name, and the power of ten in its unit.
    pub fn label(&self, label: &str) -> String {
        let power = (self.power != 0).then(|| power_of_ten(f64::from(self.power)));
        let offset = match self.offset {
            0.0 => String::new(),
            offset => format!(" {} {}", if offset < 0.0 { '+' } else { '−' }, offset.abs()),
        };
        match (label.rsplit_once(" ["), power) {
            (Some((name, unit)), Some(power)) => format!("{name}{offset} [{power} {unit}"),
            (Some((name, unit)), None) => format!("{name}{offset} [{unit}"),
            (None, Some(power)) => format!("{label}{offset} [{power}]"),
            (None, None) => format!("{label}{offset}"),
        }
    }
}

/// Rounds a value to a number of significant digits.
pub(in crate::draw) fn significant(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// Returns the smallest of the numbers ..., 1, 2, 5, 10, ... that is not less than `least`.
fn step(least: f64) -> f64 {
    let unit = libm::pow(10.0, libm::floor(libm::log10(least)));
    let steps = [1.0, 2.0, 5.0].map(|times| times * unit);
    steps.into_iter().find(|step| *step >= least * (1.0 - 1e-9)).unwrap_or(10.0 * unit)
}

/// Formats a number with fixed decimals; zero has no sign.
fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|digit| matches!(digit, '0' | '.')) => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// Formats a multiple of pi, rounded to halves, as in −π/2.
fn multiple_of_pi(share: f64) -> String {
    let halves = (2.0 * share).round();
    let sign = if halves < 0.0 { "−" } else { "" };
    let (whole, divisor) = if halves % 2.0 == 0.0 { (0.5 * halves.abs(), "") } else { (halves.abs(), "/2") };
    match whole {
        0.0 => "0".to_owned(),
        1.0 => format!("{sign}π{divisor}"),
        _ => format!("{sign}{whole}π{divisor}"),
    }
}

/// Formats a power of ten, as in 10⁻⁶.
fn power_of_ten(exponent: f64) -> String {
    let digit = |sign: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(sign.to_digit(10)? as usize);
    format!("10{}", format!("{exponent:.0}").chars().map(|sign| digit(sign).unwrap_or('⁻')).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(range: (f64, f64)) -> Span {
        Span::new(&PlotAxis { range: Some(range), ..PlotAxis::default() }, std::iter::empty(), 400.0)
    }

    #[test]
    fn ticks_are_round_and_distinct() {
        for (range, step, at, text) in [
            ((0.0, 1.57), 0.5, 0.5, "0.5"),
            ((-1.0, 1.0), 0.5, -1e-17, "0.0"),
            ((0.4700, 0.4712), 0.0005, 0.47, "0.4700"),
            ((-0.4, 0.49), 0.2, 0.2, "0.2"),
            ((-300.0, 20.0), 100.0, -200.0, "−200"),
        ] {
            let span = span(range);
            assert_eq!(span.step, step, "{range:?}");
            assert_eq!(span.text(at), text, "{range:?}");
            assert_eq!(span.label("a [m]"), "a [m]");
        }
    }

    #[test]
    fn powers_of_ten_move_into_the_label() {
        for (scale, power) in [(1e-7, "10⁻⁷"), (1e9, "10⁹"), (1e-310, "10⁻³¹⁰")] {
            let span = span((0.0, 4.0 * scale));
            assert_eq!([span.label("p [N s]"), span.label("p")], [format!("p [{power} N s]"), format!("p [{power}]")]);
            assert_eq!(span.step, 1.0);
            assert!((span.share(scale) - 0.25).abs() < 1e-9);
        }
    }

    #[test]
    fn an_axis_far_from_zero_counts_from_a_round_number() {
        for (from, length, label, last) in [
            (1.7e9 + 0.25, 0.5, "t − 1700000000 [s]", "0.7"),
            (1.7e9 - 0.25, 0.5, "t − 1699999900 [s]", "100.2"),
            (-3e7, 40.0, "t + 30000000 [s]", "40"),
            (1e9, 1e5, "t [10⁹ s]", "1.00010"),
        ] {
            let span = span((from, from + length));
            let ticks: Vec<Tick> = span.ticks().collect();
            assert_eq!((span.label("t [s]").as_str(), &*ticks[ticks.len() - 1].text), (label, last));
            assert!((span.share(from + 0.5 * length) - 0.5).abs() < 1e-6, "{label}");
            assert_eq!(span.ends(), (from, from + length));
        }
    }

    #[test]
    fn an_axis_without_a_range_has_room_about_its_values() {
        for value in [0.0, -3.0, 1e-200] {
            let span = Span::new(&PlotAxis::default(), [value, value * (1.0 + 1e-15)].into_iter(), 400.0);
            assert!((span.share(value) - 0.5).abs() < 1e-9);
        }
        // A spike beyond the limits does not widen the axis.
        let axis = PlotAxis { within: Some((-1.0, 1.0)), ..PlotAxis::default() };
        let span = Span::new(&axis, [-0.5, 0.5, 1e6].into_iter(), 400.0);
        assert!((span.share(0.25) - 0.5).abs() < 1e-9 && span.share(1e6) > 1.0);
    }
}
