//! Findings in plain words.

use crate::finding::{Finding, Severity};

/// One finding as lines of text: severity, subject, sentence, numbers, remedy.
pub fn finding_text(f: &Finding) -> String {
    let severity = match f.severity {
        Severity::Info => "note",
        Severity::Warning => "warning",
        Severity::Error => "error",
    };
    let numbers = match (f.measured, f.limit) {
        (Some(m), Some(l)) => format!(" (measured {}, limit {})", short(m), short(l)),
        (Some(m), None) => format!(" (measured {})", short(m)),
        _ => String::new(),
    };
    let remedy = if f.remedy.is_empty() {
        String::new()
    } else {
        format!("\n    remedy: {}", f.remedy)
    };
    format!(
        "{severity} [{}] {}: {}{numbers}{remedy}",
        f.code, f.subject, f.message
    )
}

/// A number with four significant digits, plain where that is readable.
pub fn short(x: f64) -> String {
    let a = x.abs();
    if x == 0.0 {
        "0".into()
    } else if (1e-3..1e6).contains(&a) {
        let digits = (3 - a.log10().floor() as i32).clamp(0, 6) as usize;
        let s = format!("{x:.digits$}");
        if s.contains('.') {
            s.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            s
        }
    } else {
        format!("{x:.3e}")
    }
}
