//! Console of a command: it fits a terminal.

use std::process::Output;

/// Lines of a command, findings included.
const LINES: usize = 25;
/// Columns where standard output is not a terminal.
const COLUMNS: usize = 100;

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Asserts that standard output and standard error fit a terminal together.
pub fn assert_fits(done: &Output, command: &str) {
    let all = text(&done.stdout) + &text(&done.stderr);
    assert!(all.lines().count() <= LINES, "{command}:\n{all}");
    for line in all.lines() {
        assert!(line.chars().count() <= COLUMNS, "{command}: {line}\n{all}");
    }
}
