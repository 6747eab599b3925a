//! verify: draws on all threads. In: a study made ready and draws that are wanted. Out: rows, handed on as they come.

use super::draw::PreparedStudy;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use windfall_model::study::Row;

/// Draws in the order given, on the threads of the current pool. `keep` takes each row as it comes, in any order, and says whether
/// to go on; a draw that was begun is always handed on.
///
/// # Errors
/// The first error of `keep`; no further draw is begun after it.
pub fn run<E, K>(prepared: &PreparedStudy, wanted: impl Iterator<Item = u64> + Send, keep: K) -> Result<(), E>
where
    E: Send,
    K: Fn(Row) -> Result<bool, E> + Sync,
{
    let wanted = Mutex::new(wanted);
    let over = AtomicBool::new(false);
    let next = || if over.load(Ordering::Relaxed) { None } else { wanted.lock().ok()?.next() };
    let work = |_: rayon::BroadcastContext<'_>| -> Result<(), E> {
        while let Some(draw) = next() {
            let went = keep(prepared.draw(draw));
            if !matches!(went, Ok(true)) {
                over.store(true, Ordering::Relaxed);
                return went.map(|_| ());
            }
        }
        Ok(())
    };
    rayon::broadcast(work).into_iter().collect()
}
