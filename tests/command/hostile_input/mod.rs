//! Input that is broken, hostile or absurdly large: each is refused with the message and the place told here, word for
//! word, in bounded time and memory: the command has 500 MB for each, and some seconds, which no case comes near to.
//!
//! At most five of a class. Where a field, a range or a name belongs is in `cli` and `loader`; here is what must not
//! harm. `files` holds what only the command meets: folders, devices, bytes that are no text.

use heelstrike::Error;
use std::collections::HashMap;

mod files;
mod limits;
mod robots;
mod states;
mod studies;
mod tables;

/// Class, input and the whole refusal: line, column, place, reason and, after a bar, the remedy.
struct Case {
    class: &'static str,
    input: String,
    refusal: &'static str,
}

fn case(class: &'static str, input: String, refusal: &'static str) -> Case {
    Case { class, input, refusal }
}

/// Checks every refusal of a table by `read`, and that the command with the `arguments` refuses each within its limits; tells
/// all differences at once.
fn assert_refused(cases: Vec<Case>, at_least: usize, arguments: &[&str], read: impl Fn(&str) -> Result<(), Error>) {
    assert!(cases.len() >= at_least);
    let (mut of_class, mut differences) = (HashMap::new(), Vec::new());
    for (at, Case { class, input, refusal }) in cases.iter().enumerate() {
        let told = match read(input) {
            Ok(()) => "accepted".to_owned(),
            Err(error) => match error.remedy() {
                Some(remedy) => format!("{error} | {remedy}"),
                None => error.to_string(),
            },
        };
        *of_class.entry(class).or_insert(0) += 1;
        if told != *refusal {
            let start: String = input.chars().take(80).collect();
            differences.push(format!("{at} ({class}, {start}):\n  told   {told:?}\n  should {refusal:?}"));
        }
    }
    assert!(of_class.values().all(|&count| count <= 5), "{of_class:?}");
    assert!(differences.is_empty(), "{}", differences.join("\n"));
    for (at, Case { class, input, .. }) in cases.iter().enumerate() {
        limits::assert_refuses(&format!("{at} ({class})"), arguments, input);
    }
}
