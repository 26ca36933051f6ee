//! Console output of a command must fit a terminal.

use std::process::Output;

/// Largest number of lines of a command, including findings.
const LINES: usize = 25;
/// Columns if standard output is not a terminal.
const COLUMNS: usize = 100;

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Fails unless standard output and standard error together fit a terminal.
pub fn assert_fits(done: &Output, command: &str) {
    let all = text(&done.stdout) + &text(&done.stderr);
    assert!(all.lines().count() <= LINES, "{command}:\n{all}");
    for line in all.lines() {
        assert!(line.chars().count() <= COLUMNS, "{command}: {line}\n{all}");
    }
}
