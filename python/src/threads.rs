//! python: work on threads of its own. In: work. Out: its result, or the exception of a signal (Ctrl-C) that came meanwhile.

use crate::errors::Raised;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};
use windfall::MOST_THREADS;

/// Time between two looks for signals.
const LOOK: Duration = Duration::from_millis(50);

/// How work is asked to end.
pub(crate) struct Stop<'a> {
    /// Work that looks at this flag brings to an end what it is at.
    pub(crate) flag: &'a AtomicBool,
    /// So long is waited for that end.
    pub(crate) patience: Duration,
}

/// Work on so many threads, 0 for one per processor. A signal's exception is raised at once; the work, which changes nothing but its
/// own memory, is left to end by itself.
pub(crate) fn on_threads<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    work: impl FnOnce() -> Result<T, Raised> + Send + 'static,
) -> PyResult<T> {
    on_threads_until(py, threads, None, work)
}

/// The same for work that looks at a flag: a signal sets it, and its exception is raised when the work has ended, when patience has, or
/// when a second signal comes.
pub(crate) fn on_threads_until<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    stop: Option<Stop<'_>>,
    work: impl FnOnce() -> Result<T, Raised> + Send + 'static,
) -> PyResult<T> {
    if threads > MOST_THREADS.into() {
        let what = format!("threads = {threads}: allowed: 1 to {MOST_THREADS}, or 0 for one per processor");
        return Err(Raised::Argument(what).into());
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Raised::from)?;
    let (done, mut when) = channel();
    let worker = thread::spawn(move || {
        // Nobody listens any more after a signal.
        let _ = done.send(pool.install(work));
    });
    let mut signal: Option<(PyErr, Instant)> = None;
    loop {
        let when = &mut when;
        match py.detach(move || when.recv_timeout(LOOK)) {
            Ok(result) => return signal.map_or_else(|| result.map_err(PyErr::from), |(exception, _)| Err(exception)),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => match py.detach(|| worker.join()) {
                Err(panic) => resume_unwind(panic),
                Ok(()) => return Err(Raised::Study("work ended without a result".to_owned()).into()),
            },
        }
        let came = py.check_signals();
        signal = match (signal, came, &stop) {
            (None, Err(exception), None) | (Some((exception, _)), Err(_), _) => return Err(exception),
            (None, Err(exception), Some(stop)) => {
                stop.flag.store(true, Ordering::Relaxed);
                Some((exception, Instant::now()))
            }
            (Some((exception, since)), Ok(()), Some(stop)) if since.elapsed() > stop.patience => return Err(exception),
            (before, Ok(()), _) => before,
        };
    }
}
