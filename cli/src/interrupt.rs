//! cli: Ctrl-C. In: the terminal's or the system's wish to end. Out: a flag, for work that has something to bring to an end.

use std::process::exit;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code after an interruption: 128 and the signal's number, as shells have it.
pub(crate) const EXIT_CODE: u8 = 130;
static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on the first Ctrl-C is a wish; the second ends the program at once.
pub(crate) fn listen() {
    let heard = || {
        if ASKED.swap(true, Ordering::Relaxed) {
            exit(i32::from(EXIT_CODE));
        }
    };
    // Without a handler Ctrl-C ends the program at once, which loses no more than a kill does.
    let _ = ctrlc::set_handler(heard);
}

/// True once an end was wished for.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
