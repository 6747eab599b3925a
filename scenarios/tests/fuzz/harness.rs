//! scenarios tests: readers on files that are nearly right. In: readers with sound files. Out: how many they answered; an input that ends in a
//! panic, takes too long or too much memory, under a reader's name, a seed and a number that make it again.

use crate::mutate::{Chance, Content, input};
use peak_alloc::PeakAlloc;
use std::fs;
use std::io::Write as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::SeqCst};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::{Duration, Instant};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;
/// Memory is counted for the process, so that readers take turns.
static TURN: Mutex<()> = Mutex::new(());
/// What the last panic said.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// Memory beyond ten times the file, bytes.
const BEYOND: usize = 100_000_000;
/// A wait without work, in wall time on a busy machine.
const WAIT: Duration = Duration::from_secs(120);

/// One reader.
pub(crate) struct Reader {
    pub(crate) name: &'static str,
    /// Sound files, from the root of the workspace; the first is accepted.
    pub(crate) seeds: &'static [&'static str],
    /// What an input is called, in a folder with the files beside it.
    pub(crate) file: &'static str,
    pub(crate) beside: &'static [&'static str],
    pub(crate) content: Content,
    /// What is done to a changed file before it is read: packed, say.
    pub(crate) finish: Option<fn(Vec<u8>) -> Vec<u8>>,
    /// Longest that an input may take, s of the processor.
    pub(crate) seconds: f64,
    /// Memory beyond ten times the file.
    pub(crate) beyond: usize,
    /// Whether it is accepted.
    pub(crate) read: fn(&Path) -> bool,
}

impl Reader {
    /// A reader of files of one kind.
    pub(crate) const fn new(name: &'static str, file: &'static str, content: Content, read: fn(&Path) -> bool) -> Self {
        Self { name, seeds: &[], file, beside: &[], content, finish: None, seconds: 2.0, beyond: BEYOND, read }
    }
}

/// How long.
#[derive(Clone, Copy)]
pub(crate) enum Until {
    Inputs(u64),
    /// So many, or so long.
    Either(u64, Duration),
}

/// What came of it.
#[derive(Default)]
pub(crate) struct Total {
    pub(crate) inputs: u64,
    pub(crate) accepted: u64,
    pub(crate) slowest_s: f64,
    pub(crate) most_bytes: usize,
    pub(crate) took: Duration,
    pub(crate) findings: Vec<String>,
}

impl Total {
    /// A row of the table.
    pub(crate) fn row(&self, name: &str) -> String {
        #[expect(clippy::cast_precision_loss, reason = "counts of inputs and bytes, for people")]
        let (share, rate, mb) = (
            100.0 * self.accepted as f64 / self.inputs.max(1) as f64,
            self.inputs as f64 / self.took.as_secs_f64(),
            self.most_bytes as f64 / 1e6,
        );
        format!("| {name} | {} | {share:.0} % | {rate:.0} | {:.0} | {mb:.1} |", self.inputs, 1e3 * self.slowest_s)
    }
}

/// Time of the processor that this process has had, s; where the system does not say, time as it goes by.
fn cpu_s() -> f64 {
    static START: LazyLock<Instant> = LazyLock::new(Instant::now);
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let ticks: Option<u32> = stat.rsplit(')').next().and_then(|rest| {
        let mut fields = rest.split_whitespace().skip(11);
        let user: u32 = fields.next()?.parse().ok()?;
        Some(user + fields.next()?.parse::<u32>().ok()?)
    });
    // Linux counts hundredths of a second.
    ticks.map_or_else(|| START.elapsed().as_secs_f64(), |t| f64::from(t) / 100.0)
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The folder of a reader: the files beside the input.
fn bench(reader: &Reader) -> tempfile::TempDir {
    let dir = tempfile::tempdir().expect("a temporary folder");
    for file in reader.beside {
        let from = root().join(file);
        fs::copy(&from, dir.path().join(from.file_name().expect("a file"))).expect("a file of the corpus");
    }
    dir
}

/// Runs inputs `from..` of a seed, and before them the sound files and those that were once found.
pub(crate) fn run(reader: &Reader, seed: u64, from: u64, until: Until) -> Total {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|info| *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = info.to_string()));
    let seeds: Vec<Vec<u8>> = reader.seeds.iter().map(|s| fs::read(root().join(s)).expect("a sound file")).collect();
    let dir = bench(reader);
    let one = One { reader, path: dir.path().join(reader.file), watch: Watch::default() };
    let mut total = Total::default();
    std::thread::scope(|scope| {
        scope.spawn(|| one.watch.over(reader, &one.path, seed));
        let start = Instant::now();
        let finish = |bytes: Vec<u8>| reader.finish.map_or_else(|| bytes.clone(), |f| f(bytes.clone()));
        for (i, bytes) in seeds.iter().enumerate() {
            let before = total.accepted;
            one.see(&finish(bytes.clone()), &format!("seed-{i}"), &mut total);
            if i == 0 && total.accepted == before {
                total.findings.push(format!("{}: its first sound file is refused", reader.name));
            }
        }
        for (name, bytes) in found(reader) {
            one.see(&bytes, &name, &mut total);
        }
        let more = |index: u64| match until {
            Until::Inputs(n) => index - from < n,
            Until::Either(n, t) => index - from < n && start.elapsed() < t,
        };
        let mut index = from;
        while more(index) {
            let mut chance = Chance::new(seed, reader.name, index);
            let made = finish(input(&seeds, reader.content, &mut chance));
            one.watch.index.store(index, SeqCst);
            one.see(&made, &format!("{seed}-{index}"), &mut total);
            index += 1;
        }
        total.took = start.elapsed();
        one.watch.done.store(true, SeqCst);
    });
    std::panic::set_hook(hook);
    total
}

/// Inputs that once ended in one of these ways, by name.
fn found(reader: &Reader) -> Vec<(String, Vec<u8>)> {
    let folder = root().join("scenarios/tests/fuzz/found").join(reader.name);
    let mut all: Vec<PathBuf> = fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
    all.sort();
    all.iter().map(|p| (p.display().to_string(), fs::read(p).expect("readable"))).collect()
}

/// One reader at work.
struct One<'r> {
    reader: &'r Reader,
    path: PathBuf,
    watch: Watch,
}

impl One<'_> {
    fn see(&self, bytes: &[u8], name: &str, total: &mut Total) {
        fs::write(&self.path, bytes).expect("the temporary folder is writable");
        MEMORY.reset_peak_usage();
        let before = MEMORY.current_usage();
        let start = Instant::now();
        let turn = self.watch.begin();
        let ended = catch_unwind(AssertUnwindSafe(|| (self.reader.read)(&self.path)));
        let took = start.elapsed().as_secs_f64();
        let worked = self.watch.end(turn);
        let most = MEMORY.peak_usage().saturating_sub(before);
        total.inputs += 1;
        total.slowest_s = total.slowest_s.max(took);
        total.most_bytes = total.most_bytes.max(most);
        let wrong = match ended {
            Ok(accepted) => {
                total.accepted += u64::from(accepted);
                None
            }
            Err(_) => Some(PANIC.lock().unwrap_or_else(PoisonError::into_inner).clone()),
        };
        let wrong = wrong
            .or_else(|| (worked > self.reader.seconds).then(|| format!("took {worked:.1} s")))
            .or_else(|| (most > 10 * bytes.len() + self.reader.beyond).then(|| format!("took {most} bytes for {}", bytes.len())));
        if let Some(what) = wrong {
            let kept = keep(self.reader, bytes, name);
            total.findings.push(format!("{} {name}: {what}; kept in {}", self.reader.name, kept.display()));
        }
    }
}

/// Keeps an input for whoever mends what it found.
fn keep(reader: &Reader, bytes: &[u8], name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{}-{}", reader.name, name.replace(['/', '\\'], "_")));
    fs::write(&path, bytes).expect("the target folder is writable");
    path
}

/// Ends the process when an input does not end: a thread cannot be ended from outside. Times are the processor's, for a busy machine makes
/// every input long.
#[derive(Default)]
struct Watch {
    index: AtomicU64,
    /// Inputs begun and ended; odd while one is read.
    turn: AtomicU64,
    /// The turn that was last looked at, and how long it had worked, ms.
    seen: AtomicU64,
    worked_ms: AtomicU64,
    done: AtomicBool,
}

impl Watch {
    fn begin(&self) -> u64 {
        self.turn.fetch_add(1, SeqCst) + 1
    }
    /// How long the input has worked, s; 0 for one that nobody looked at.
    fn end(&self, turn: u64) -> f64 {
        self.turn.fetch_add(1, SeqCst);
        #[expect(clippy::cast_precision_loss, reason = "milliseconds of a process")]
        let worked = self.worked_ms.load(SeqCst) as f64 * 1e-3;
        if self.seen.load(SeqCst) == turn { worked } else { 0.0 }
    }
    fn over(&self, reader: &Reader, path: &Path, seed: u64) {
        let (mut turn, mut began, mut since) = (0, 0.0, Instant::now());
        while !self.done.load(SeqCst) {
            std::thread::sleep(Duration::from_millis(50));
            let now = self.turn.load(SeqCst);
            if now.is_multiple_of(2) || now != turn {
                (turn, began, since) = (now, cpu_s(), Instant::now());
            }
            let cpu = cpu_s() - began;
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "milliseconds of a process")]
            self.worked_ms.store((cpu * 1e3) as u64, SeqCst);
            self.seen.store(turn, SeqCst);
            if !turn.is_multiple_of(2) && (cpu > 2.0 * reader.seconds + 1.0 || since.elapsed() > WAIT) {
                let index = self.index.load(SeqCst);
                let kept = keep(reader, &fs::read(path).unwrap_or_default(), &format!("{seed}-{index}"));
                let what = format!("{} {seed}-{index}: has no end after {cpu:.1} s; kept in {}\n", reader.name, kept.display());
                // Past the test's own capture, which is lost with the process.
                let _ = std::io::stderr().write_all(what.as_bytes());
                std::process::exit(1);
            }
        }
    }
}

/// What `WINDFALL_FUZZ` names (all, when it names nothing), for `WINDFALL_FUZZ_SECONDS` (60) or `WINDFALL_FUZZ_INPUTS` (ten million) each, by
/// `WINDFALL_FUZZ_SEED` (1) from input `WINDFALL_FUZZ_FROM` (0): rows of the table as they are done, and what was found.
pub(crate) fn as_asked(readers: &[Reader]) -> Vec<String> {
    let number = |key: &str, default: u64| std::env::var(key).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    let wanted = std::env::var("WINDFALL_FUZZ").unwrap_or_default();
    let until =
        Until::Either(number("WINDFALL_FUZZ_INPUTS", 10_000_000), Duration::from_secs(number("WINDFALL_FUZZ_SECONDS", 60)));
    let (seed, from) = (number("WINDFALL_FUZZ_SEED", 1), number("WINDFALL_FUZZ_FROM", 0));
    let mut findings = Vec::new();
    eprintln!("| reader | inputs | accepted | inputs/s | slowest, ms | most memory, MB |\n|---|---|---|---|---|---|");
    for reader in readers.iter().filter(|r| wanted.is_empty() || wanted.split(',').any(|w| w == r.name)) {
        let total = run(reader, seed, from, until);
        eprintln!("{}", total.row(reader.name));
        for finding in total.findings.iter().take(20) {
            eprintln!("  {finding}");
        }
        findings.extend(total.findings);
    }
    findings
}
