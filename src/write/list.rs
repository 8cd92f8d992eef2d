//! Lists of names for people, cut short.

/// The names that there is `room` for, at least the first, and how many more there are.
pub(crate) fn list(names: &[impl AsRef<str>], room: usize) -> String {
    let lengths = names.iter().map(|name| name.as_ref().chars().count() + 2);
    let ends = lengths.scan(0, |end, length| {
        *end += length;
        Some(*end)
    });
    let shown = ends.take_while(|&end| end <= room + 2).count().max(1).min(names.len());
    let mut text = names[..shown].iter().map(AsRef::as_ref).collect::<Vec<_>>().join(", ");
    if shown < names.len() {
        text.push_str(&format!(" and {} more", names.len() - shown));
    }
    text
}
