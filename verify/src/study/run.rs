//! verify: draws, and other pieces of work, on all threads. In: what is wanted. Out: results, handed on as they come.

use super::draw::PreparedStudy;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use windfall_model::study::Row;

/// Draws that fly side by side at most: as many as the widest vector unit has lanes.
const SIDE: u64 = 8;

/// Draws in the order given, as [`each`] does, some at a time: fewer toward the end, so that all threads end together.
///
/// # Errors
/// The first error of `keep`; no further draw is begun after it.
pub fn run<E, K>(prepared: &PreparedStudy, wanted: Vec<Range<u64>>, keep: K) -> Result<(), E>
where
    E: Send,
    K: Fn(Row) -> Result<bool, E> + Sync,
{
    let mut left: u64 = wanted.iter().map(|r| r.end - r.start).sum();
    let shares = 2 * rayon::current_num_threads() as u64;
    let mut draws = wanted.into_iter().flatten();
    let groups = std::iter::from_fn(move || {
        let size = left.div_ceil(shares).min(SIDE);
        left -= size;
        (size > 0).then(|| (0..size).filter_map(|_| draws.next()).collect::<Vec<u64>>())
    });
    each(
        groups,
        |group| prepared.draws(group),
        |rows| {
            for row in rows {
                if !keep(row)? {
                    return Ok(false);
                }
            }
            Ok(true)
        },
    )
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
