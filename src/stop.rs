//! Whether work is to stop: looked at between the parts of long computations.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A handle on the wish to stop; those cloned from one another share it. The default is never stopped.
///
/// What was stopped comes back early with less than was asked for: whoever may stop asks [`Stop::is_asked`] before using the answer.
#[derive(Clone, Debug, Default)]
pub struct Stop(Option<Arc<AtomicBool>>);

impl Stop {
    /// One that can be asked for.
    pub fn new() -> Self {
        Self(Some(Arc::new(AtomicBool::new(false))))
    }

    /// Asks to stop; nothing where this is the default.
    pub fn ask(&self) {
        if let Some(asked) = &self.0 {
            asked.store(true, Ordering::Relaxed);
        }
    }

    /// Whether the work is to stop.
    pub fn is_asked(&self) -> bool {
        self.0.as_ref().is_some_and(|a| a.load(Ordering::Relaxed))
    }
}

/// No part of what is asked: all are alike.
impl PartialEq for Stop {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for Stop {}

#[cfg(test)]
mod tests;
