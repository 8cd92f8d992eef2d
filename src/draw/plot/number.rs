//! Numbers of an SVG, with two decimals at most: a hundredth of a pixel is seen by nobody.
//!
//! kuva rounds to hundredths by `(v * 100).round() * 0.01` and writes all digits of the product: 275.34000000000003.

/// Appends `value` with at most two decimals.
pub(super) fn append(out: &mut String, value: f64) {
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    out.push_str(if short == "-0" { "0" } else { short });
}

/// The SVG with every number inside of its tags shortened; texts between tags stay.
pub(super) fn shortened(svg: &str) -> String {
    let mut out = String::with_capacity(svg.len());
    let mut inside = false;
    let mut rest = svg;
    while let Some(first) = rest.chars().next() {
        let digits = rest.len() - rest.trim_start_matches(|at: char| at.is_ascii_digit() || at == '.').len();
        let (token, after) = rest.split_at(if digits > 0 { digits } else { first.len_utf8() });
        match (first, inside, token.split_once('.')) {
            (_, true, Some((_, decimals))) if decimals.len() > 2 => match token.parse() {
                Ok(value) => append(&mut out, value),
                Err(_) => out.push_str(token),
            },
            _ => out.push_str(token),
        }
        match first {
            '<' => inside = true,
            '>' => inside = false,
            _ => {}
        }
        rest = after;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_tags_are_shortened_and_texts_are_not() {
        let svg = "<a x=\"275.34000000000003\" d=\"M -0.001 7L1.5 -2.999\">0.12345 &lt; é</a>";
        assert_eq!(shortened(svg), "<a x=\"275.34\" d=\"M -0 7L1.5 -3\">0.12345 &lt; é</a>");
    }

    #[test]
    fn nothing_is_minus_zero() {
        let mut out = String::new();
        for value in [-0.001, 2.0, 2.5, -7.126] {
            append(&mut out, value);
            out.push(' ');
        }
        assert_eq!(out, "0 2 2.5 -7.13 ");
    }
}
