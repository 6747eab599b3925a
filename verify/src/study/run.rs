//! verify: draws, and other pieces of work, on all threads. In: what is wanted. Out: results, handed on as they come.

use super::draw::PreparedStudy;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use windfall_model::study::Row;

/// Draws in the order given, as [`each`] does.
///
/// # Errors
/// The first error of `keep`; no further draw is begun after it.
pub fn run<E, K>(prepared: &PreparedStudy, wanted: impl Iterator<Item = u64> + Send, keep: K) -> Result<(), E>
where
    E: Send,
    K: Fn(Row) -> Result<bool, E> + Sync,
{
    each(wanted, |draw| prepared.draw(draw), keep)
}

/// Pieces of work in the order given, on the threads of the current pool. `keep` takes each result as it comes, in any order, and says
/// whether to go on; work that was begun is always handed on.
///
/// # Errors
/// The first error of `keep`; nothing further is begun after it.
pub fn each<W, T, E, K>(wanted: impl Iterator<Item = W> + Send, make: impl Fn(W) -> T + Sync, keep: K) -> Result<(), E>
where
    E: Send,
    K: Fn(T) -> Result<bool, E> + Sync,
{
    let wanted = Mutex::new(wanted);
    let over = AtomicBool::new(false);
    let next = || if over.load(Ordering::Relaxed) { None } else { wanted.lock().ok()?.next() };
    let work = |_: rayon::BroadcastContext<'_>| -> Result<(), E> {
        while let Some(one) = next() {
            let went = keep(make(one));
            if !matches!(went, Ok(true)) {
                over.store(true, Ordering::Relaxed);
                return went.map(|_| ());
            }
        }
        Ok(())
    };
    rayon::broadcast(work).into_iter().collect()
}
