//! Stop request for long computations, which check it between their parts.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Handle of a stop request. Clones share the request. The default handle is never stopped.
///
/// A stopped computation returns early with an incomplete result. Callers check [`Stop::is_asked`] before they use the result.
#[derive(Clone, Debug, Default)]
pub struct Stop(Option<Arc<AtomicBool>>);

impl Stop {
    /// Returns a handle with which a stop can be requested.
    pub fn new() -> Self {
        Self(Some(Arc::new(AtomicBool::new(false))))
    }

    /// Requests a stop. Has no effect on the default handle.
    pub fn ask(&self) {
        if let Some(asked) = &self.0 {
            asked.store(true, Ordering::Relaxed);
        }
    }

    /// Returns whether a stop was requested.
    pub fn is_asked(&self) -> bool {
        self.0.as_ref().is_some_and(|a| a.load(Ordering::Relaxed))
    }
}

/// A stop request is not a part of a question, so all values are equal.
impl PartialEq for Stop {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Eq for Stop {}

#[cfg(test)]
mod tests;
