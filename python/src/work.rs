//! Work without the interpreter's lock, on separate threads.
//!
//! Ctrl-C stops it between stages and between the cases, runs, files and trials of a stage. A bug in it becomes an exception. Every call has a
//! separate pool, which ends with the call, so a forked process does not lack threads.

use crate::fault::{argument_fault, raise};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use strainbridge::host::context::Progress;
use strainbridge::stop::Stop;

/// Bytes of stack of a working thread, as in the command.
const STACK: usize = 8 << 20;
/// Period at which the calling thread checks for Ctrl-C and reports progress.
const LOOK: Duration = Duration::from_millis(50);

/// Number of threads, and the callback for progress.
#[derive(Default)]
pub(crate) struct Asked {
    /// Number of threads. `None`: all cores of the machine.
    pub threads: Option<usize>,
    /// Callback with stage, completed parts and total parts (0: unknown).
    pub progress: Option<Py<PyAny>>,
}

/// Panic value that unwinds cancelled work.
struct Stopped;

/// Progress of the work, and whether it must stop.
#[derive(Default)]
pub(crate) struct Heard {
    stage: Mutex<String>,
    done: AtomicUsize,
    total: AtomicUsize,
    stop: Stop,
}

impl Progress for Heard {
    fn begin(&self, stage: &str) {
        self.leave_if_stopped();
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = stage.to_owned();
        self.parts(0);
    }

    fn parts(&self, total: usize) {
        self.done.store(0, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
    }

    fn advance(&self, parts: usize) {
        self.leave_if_stopped();
        self.done.fetch_add(parts, Ordering::Relaxed);
    }

    fn stop(&self) -> Stop {
        self.stop.clone()
    }
}

impl Heard {
    /// Unwinds cancelled work from a point where it reports progress. [`run`] ends the unwinding. Half-written files are removed on the way.
    fn leave_if_stopped(&self) {
        if self.is_cancelled() && !std::thread::panicking() {
            resume_unwind(Box::new(Stopped));
        }
    }

    /// Checks for Ctrl-C and reports progress.
    fn look(&self, asked: &Asked) -> PyResult<()> {
        Python::attach(|py| {
            py.check_signals()?;
            if let Some(told) = &asked.progress {
                let stage = self.stage.lock().map(|s| s.clone()).unwrap_or_default();
                let load = |n: &AtomicUsize| n.load(Ordering::Relaxed);
                told.call1(py, (stage, load(&self.done), load(&self.total)))?;
            }
            Ok(())
        })
    }
}

/// Runs `work` on separate threads and returns its result.
///
/// # Errors
/// `KeyboardInterrupt`, and any exception of the progress callback, once the work has stopped. `RuntimeError` if it panics.
pub(crate) fn run<T: Send>(
    py: Python,
    asked: &Asked,
    work: impl FnOnce(&Heard) -> T + Send,
) -> PyResult<T> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(asked.threads.map_or(0, |n| n.max(1)))
        .stack_size(STACK)
        .build();
    let pool = pool.map_err(|e| {
        let fault = argument_fault(
            "threads",
            "threads",
            &e.to_string(),
            "ask for fewer threads",
        );
        raise(py, fault.into())
    })?;
    let heard = Heard {
        stop: Stop::new(),
        ..Heard::default()
    };
    py.detach(|| {
        std::thread::scope(|scope| {
            let (alive, ended) = channel::<()>();
            let (heard, pool) = (&heard, &pool);
            let worker = scope.spawn(move || {
                let _alive = alive;
                pool.install(|| work(heard))
            });
            let mut stopped = None;
            while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(LOOK) {
                if stopped.is_none()
                    && let Err(e) = heard.look(asked)
                {
                    heard.stop.ask();
                    stopped = Some(e);
                }
            }
            match (stopped, worker.join()) {
                (Some(e), _) => Err(e),
                (None, Ok(done)) => Ok(done),
                (None, Err(panic)) => Err(bug(&*panic)),
            }
        })
    })
}

/// Returns the exception for a bug in the program.
fn bug(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_owned());
    let said = text.or_else(|| panic.downcast_ref::<String>().cloned());
    PyRuntimeError::new_err(format!(
        "an error of strainbridge, not of its input: {}: report it with the call that led to it",
        said.unwrap_or_default()
    ))
}

/// Fails as a bug would, for tests.
#[pyfunction(name = "_fail")]
pub(crate) fn fail(py: Python, threads: Option<usize>) -> PyResult<usize> {
    let asked = Asked {
        threads,
        progress: None,
    };
    run(py, &asked, |heard| {
        assert!(heard.is_cancelled(), "asked to fail");
        0
    })
}
