//! Progress on a terminal, for work that takes over a second: the stage, its elapsed time and, if known, the time left.

use crate::host::context::Progress;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Finished part of a stage.
#[derive(Default)]
struct Meter {
    done: AtomicU64,
    total: AtomicU64,
}

impl Meter {
    /// Begins a stage of so many parts; 0: it is not known.
    fn begin(&self, total: usize) {
        self.done.store(0, Ordering::Relaxed);
        self.total.store(total as u64, Ordering::Relaxed);
    }

    /// So many parts more are done.
    fn advance(&self, parts: usize) {
        self.done.fetch_add(parts as u64, Ordering::Relaxed);
    }

    /// Returns the share done and the time left after `elapsed`; `None` if nothing is known yet.
    fn estimate_time_left(&self, elapsed: Duration) -> Option<(f64, Duration)> {
        let done = self.done.load(Ordering::Relaxed);
        let total = self.total.load(Ordering::Relaxed);
        if done == 0 || total == 0 {
            return None;
        }
        let share = (done as f64 / total as f64).min(1.0);
        Some((share, elapsed.mul_f64((1.0 - share) / share)))
    }
}

/// Time after which a progress line appears.
const PATIENCE: Duration = Duration::from_secs(1);
/// Period at which the remaining time is updated.
const TICK: Duration = Duration::from_millis(250);

/// Line of standard error with the stage in progress. Nothing is printed if standard error is not a terminal.
#[derive(Default)]
pub struct Terminal {
    meter: Arc<Meter>,
    stages: Mutex<Vec<Line>>,
}

impl Progress for Terminal {
    fn begin(&self, stage: &str) {
        self.meter.begin(0);
        let line = Line::start(stage, &self.meter);
        let mut stages = self.stages.lock().unwrap_or_else(PoisonError::into_inner);
        stages.push(line);
    }

    fn end(&self) {
        let mut stages = self.stages.lock().unwrap_or_else(PoisonError::into_inner);
        stages.pop();
    }

    fn parts(&self, total: usize) {
        self.meter.begin(total);
    }

    fn advance(&self, parts: usize) {
        self.meter.advance(parts);
    }
}

/// A spinner that appears after a second and goes when dropped.
struct Line {
    stop: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Line {
    fn start(what: &str, meter: &Arc<Meter>) -> Self {
        if !std::io::stderr().is_terminal() {
            return Self {
                stop: None,
                thread: None,
            };
        }
        let (stop, stopped) = channel::<()>();
        let (what, meter, began) = (what.to_owned(), Arc::clone(meter), Instant::now());
        let thread = std::thread::spawn(move || {
            if stopped.recv_timeout(PATIENCE) != Err(RecvTimeoutError::Timeout) {
                return;
            }
            let spinner = indicatif::ProgressBar::new_spinner();
            if let Ok(style) = indicatif::ProgressStyle::with_template("{spinner} {msg} {elapsed}")
            {
                spinner.set_style(style);
            }
            spinner.set_message(what.clone());
            spinner.enable_steady_tick(Duration::from_millis(120));
            while stopped.recv_timeout(TICK) == Err(RecvTimeoutError::Timeout) {
                if let Some((share, left)) = meter.estimate_time_left(began.elapsed()) {
                    let (percent, seconds) = (100.0 * share, left.as_secs());
                    spinner.set_message(format!("{what}: {percent:.0} %, about {seconds} s left;"));
                }
            }
            spinner.finish_and_clear();
        });
        Self {
            stop: Some(stop),
            thread: Some(thread),
        }
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        drop(self.stop.take());
        if let Some(t) = self.thread.take() {
            let _ = t.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_done_in_ten_seconds_leaves_thirty() {
        let meter = Meter::default();
        assert_eq!(meter.estimate_time_left(Duration::from_secs(10)), None);
        meter.begin(8);
        meter.advance(2);
        let left = meter.estimate_time_left(Duration::from_secs(10));
        assert_eq!(left, Some((0.25, Duration::from_secs(30))));
    }
}
