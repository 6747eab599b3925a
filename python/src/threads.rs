//! python: work on threads of its own. In: work. Out: its result, or the exception of a signal (Ctrl-C) that came meanwhile.

use crate::errors::Raised;
use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Time between two looks for signals.
const LOOK: Duration = Duration::from_millis(50);

/// Work on so many threads, 0 for one per processor. A signal's exception is raised at once; the work, which changes nothing but its
/// own memory, is left to end by itself.
pub(crate) fn on_threads<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    work: impl FnOnce() -> Result<T, Raised> + Send + 'static,
) -> PyResult<T> {
    on_threads_until(py, threads, None, work)
}

/// The same for work that looks at a flag: a signal sets it, and its exception is raised when the work has ended.
pub(crate) fn on_threads_until<T: Send + 'static>(
    py: Python<'_>,
    threads: usize,
    stop: Option<&AtomicBool>,
    work: impl FnOnce() -> Result<T, Raised> + Send + 'static,
) -> PyResult<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Raised::from)?;
    let (done, mut when) = channel();
    let worker = thread::spawn(move || {
        // Nobody listens any more after a signal.
        let _ = done.send(pool.install(work));
    });
    let mut signal: PyResult<()> = Ok(());
    loop {
        let when = &mut when;
        match py.detach(move || when.recv_timeout(LOOK)) {
            Ok(result) => return signal.and(result.map_err(PyErr::from)),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => match py.detach(|| worker.join()) {
                Err(panic) => resume_unwind(panic),
                Ok(()) => return Err(Raised::Study("work ended without a result".to_owned()).into()),
            },
        }
        if signal.is_ok()
            && let Err(exception) = py.check_signals()
        {
            let Some(stop) = stop else { return Err(exception) };
            stop.store(true, Ordering::Relaxed);
            signal = Err(exception);
        }
    }
}
