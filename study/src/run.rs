//! study: draws, and other pieces of work, on all threads. In: what is wanted. Out: results, handed on as they come.

use super::draw::{FlownRow, PreparedStudy};
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};
use windfall_model::study::Row;

/// Draws that fly side by side: as many as the widest vector unit has lanes.
const SIDE: usize = 8;

/// What a thread does next.
enum Task<'p> {
    Fly(Vec<u64>),
    Row(u64, Option<Box<FlownRow<'p>>>),
}

/// Draws that are left, and those that are flown and wait for the rest.
struct Queue<'p, I> {
    draws: I,
    flown: VecDeque<(u64, Option<Box<FlownRow<'p>>>)>,
    /// Threads that are flying.
    flying: usize,
    over: bool,
}

impl<'p, I: Iterator<Item = u64>> Queue<'p, I> {
    /// Flights while few draws wait, so that all threads have something to do until the last flights are over.
    fn next(&mut self, few: usize) -> Option<Task<'p>> {
        if self.flown.len() < few {
            let draws: Vec<u64> = self.draws.by_ref().take(SIDE).collect();
            if !draws.is_empty() {
                self.flying += 1;
                return Some(Task::Fly(draws));
            }
        }
        self.flown.pop_front().map(|(draw, flown)| Task::Row(draw, flown))
    }
}

/// Draws on the threads of the current pool: flown side by side in the order given, each row made by whoever is free. `keep` takes each row as it
/// comes, in any order, and says whether to go on.
///
/// # Errors
/// The first error of `keep`; no further row is begun after it.
pub fn run<E, K>(prepared: &PreparedStudy, wanted: Vec<Range<u64>>, keep: K) -> Result<(), E>
where
    E: Send,
    K: Fn(Row) -> Result<bool, E> + Sync,
{
    let few = SIDE / 2 * rayon::current_num_threads();
    let queue = Mutex::new(Queue { draws: wanted.into_iter().flatten(), flown: VecDeque::new(), flying: 0, over: false });
    let changed = Condvar::new();
    let lock = || queue.lock().unwrap_or_else(PoisonError::into_inner);
    let next = || {
        let mut queue = lock();
        loop {
            if queue.over {
                return None;
            }
            let task = queue.next(few);
            if task.is_some() || queue.flying == 0 {
                return task;
            }
            queue = changed.wait(queue).unwrap_or_else(PoisonError::into_inner);
        }
    };
    let work = |_: rayon::BroadcastContext<'_>| -> Result<(), E> {
        while let Some(task) = next() {
            match task {
                Task::Fly(draws) => {
                    let flown = prepared.fly(&draws);
                    let mut queue = lock();
                    queue.flown.extend(draws.into_iter().zip(flown));
                    queue.flying -= 1;
                    changed.notify_all();
                }
                Task::Row(draw, flown) => {
                    let went = keep(prepared.row(draw, flown));
                    if !matches!(went, Ok(true)) {
                        lock().over = true;
                        changed.notify_all();
                        return went.map(|_| ());
                    }
                }
            }
        }
        Ok(())
    };
    rayon::broadcast(work).into_iter().collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    const STUDY: &str = "[study]\nname = \"beside\"\nscenario = \"short.toml\"\ndraws = 11\nseed = 1\n[do]\nidentify = [\"equation-error\"]\n\
        [[vary]]\nquantity = \"vehicle.mass_kg\"\nuniform = { low = 0.7, high = 0.9 }\n";

    fn prepared() -> PreparedStudy {
        static COUNT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
        let name = format!("windfall-beside-{}-{}", std::process::id(), COUNT.fetch_add(1, Ordering::Relaxed));
        let folder = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&folder).expect("writable");
        let scenario = windfall_scenarios::bundled("sage-perturbed").expect("bundled");
        let short = scenario.replace("duration_s = 18.3", "duration_s = 4.0");
        assert_ne!(short, scenario);
        std::fs::write(folder.join("short.toml"), short).expect("writable");
        std::fs::write(folder.join("study.toml"), STUDY).expect("writable");
        let file = windfall_scenarios::read_study(&folder.join("study.toml")).expect("a study");
        std::fs::remove_dir_all(&folder).expect("own folder");
        PreparedStudy::new(file.study, None).expect("can be flown")
    }

    /// Eleven draws on some threads, by number.
    fn rows(prepared: &PreparedStudy, threads: usize) -> Vec<Row> {
        let kept = Mutex::new(Vec::new());
        let keep = |row| {
            kept.lock().expect("no panic").push(row);
            Ok::<_, ()>(true)
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| run(prepared, vec![0..4, 4..11], keep)).expect("nothing fails");
        let mut rows = kept.into_inner().expect("no panic");
        rows.sort_by_key(|row: &Row| row.draw);
        rows
    }

    #[test]
    fn law_rows_do_not_depend_on_threads_or_on_who_flies_beside() {
        let prepared = prepared();
        let alone: Vec<Row> = (0..11).map(|draw| prepared.draw(draw)).collect();
        let failure = prepared.place("failure").expect("a column");
        assert!(alone.iter().all(|row| row.cells[failure] == windfall_model::study::Cell::Word(String::new())));
        for threads in [1, 3] {
            assert_eq!(rows(&prepared, threads), alone, "{threads} threads");
        }
    }

    /// No row more is begun after `keep` says that it is enough, or fails.
    #[test]
    fn law_it_ends_when_told() {
        let prepared = prepared();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("threads");
        for last in [Ok(false), Err("full")] {
            let kept = std::sync::atomic::AtomicUsize::new(0);
            let keep = |_| if kept.fetch_add(1, Ordering::Relaxed) == 2 { last } else { Ok(true) };
            assert_eq!(pool.install(|| run(&prepared, std::iter::once(0..11).collect(), keep)).is_err(), last.is_err());
            assert_eq!(kept.into_inner(), 3);
        }
    }
}
