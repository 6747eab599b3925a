//! study tests: what a summary holds does not grow with the number of draws. In: a counting allocator, columns made on the fly. Out:
//! the largest heap.
//!
//! A binary of its own, with one test: the counter sees every thread.

use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::cell::Cell as Slot;
use windfall_model::study::{Cell, CellKind, Column};
use windfall_scenarios::read_study;
use windfall_study::{PreparedStudy, summarise};

#[global_allocator]
static GLOBAL: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

const STUDY: &str = "[study]\nname = \"flat\"\nscenario = \"sage-perturbed.toml\"\ndraws = 1000000\nseed = 1\n[do]\nidentify = [\"equation-error\"]\n";

/// Largest heap beyond what was there, bytes, while so many draws are summarised.
fn peak(prepared: &PreparedStudy, draws: u64) -> usize {
    let region = Region::new(GLOBAL);
    let peak = Slot::new(0);
    let each = |column: &Column, see: &mut dyn FnMut(Cell)| {
        for draw in 0..draws {
            let x = (draw.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64;
            see(match column.kind {
                CellKind::Number => Cell::Number((draw % 7 != 0).then_some(x - 1e15)),
                CellKind::Flag => Cell::Flag(Some(draw % 3 == 0)),
                CellKind::Word => Cell::Word(String::new()),
            });
            if draw % 512 == 0 {
                let change = region.change();
                peak.set(peak.get().max(change.bytes_allocated.saturating_sub(change.bytes_deallocated)));
            }
        }
        Ok::<(), ()>(())
    };
    let summary = summarise(prepared, draws, each).expect("nothing fails");
    assert_eq!(summary.draws, draws);
    peak.get()
}

#[test]
fn law_a_summary_holds_as_much_of_many_draws_as_of_few() {
    let folder = std::env::temp_dir().join(format!("windfall-memory-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("writable");
    let scenario = windfall_scenarios::bundled("sage-perturbed").expect("bundled");
    std::fs::write(folder.join("sage-perturbed.toml"), scenario).expect("writable");
    std::fs::write(folder.join("study.toml"), STUDY).expect("writable");
    let file = read_study(&folder.join("study.toml")).expect("a study");
    let prepared = PreparedStudy::new(file.study, None).expect("can be flown");
    std::fs::remove_dir_all(&folder).expect("own folder");
    let (few, many) = (peak(&prepared, 1_000), peak(&prepared, 50_000));
    // A column of 50,000 numbers would be 400 kB. What differs is at most the harness' own thread and growth of small lists.
    assert!(many < few + 20_000, "{few} bytes of 1,000 draws, {many} of 50,000");
}
