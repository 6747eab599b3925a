//! cli: the words of the command line. In: arguments. Out: commands as typed.

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;
use windfall::MOST_THREADS;

/// Verification-first simulator of a tethered lander in a vertical wind tunnel, and identifier of its aerodynamics.
///
/// Exit codes: 0 done; 1 done, and the verdict is no; 2 bad input or usage; 3 numerical failure.
#[derive(Debug, Parser)]
#[command(name = "windfall", version, arg_required_else_help = true, max_term_width = 110)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// One word each.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Fly a scenario; record and truth apart
    Simulate(SimulateArgs),
    /// Estimate parameters with intervals; each kind of run alone and combined
    Identify(IdentifyArgs),
    /// Which aerodynamic terms the runs carry, whatever is declared; a structure file to declare them
    ///
    /// Candidates are what the body's symmetry admits. Of all their subsets that is taken which the likelihood of the runs pays for, each
    /// spurious candidate entering by a stated chance.
    Structure(StructureArgs),
    /// How much more tunnel time, from which release angle, brings a parameter's error where it is wanted
    Plan(PlanArgs),
    /// Fly the identified model against each run
    Resimulate(ResimulateArgs),
    /// Fly an identified model down to the ground of a planet, many times: its whole posterior, gusts, a scattered start
    ///
    /// Attitude, rates and speed over height and at touch-down, with intervals that carry the identification's uncertainty, and the
    /// parameters that they hang on most.
    Descend(DescendArgs),
    /// Find what the declared model lacks: residual, effect, its numbers, errors before and after
    ///
    /// Exit code 1 when something is left that nothing named accounts for, or held-out runs contradict what was identified (verdict
    /// "unexplained", whatever effects come near); 0 when all that is left is noise, without an effect ("consistent") or with one ("effect").
    Close(CloseArgs),
    /// Many draws around a scenario or campaign: what a test will tell
    ///
    /// The same bits on any number of threads, in shards, or resumed after a kill. Parts are kept in DIR/parts until all are there.
    Study(StudyArgs),
    /// One verb over every campaign of a folder: a table, parameters pooled over campaigns, a page
    ///
    /// A campaign that is refused or fails is a row with its reason. The same bytes on any number of threads, in shards, or resumed after a
    /// kill.
    Many(ManyArgs),
    /// The page for a folder of results
    Report(ReportArgs),
    /// Every check of the program's own truth; figure beside bound
    Verify(VerifyArgs),
    /// Read a file, validate it and print what was understood
    Check(CheckArgs),
    /// Write a commented campaign for run files; guesses are marked, what no record tells is left to fill in
    ///
    /// The last of several files is held out. Every column that nothing reads is named in the file.
    Init(InitArgs),
    /// What a family of effects, a key, a word on the screen or a warning means, and where that is from
    Explain(ExplainArgs),
    /// Write the manual pages, windfall.1 and one for each command
    Manual {
        /// Folder for the pages, made if missing
        folder: PathBuf,
    },
    /// Print a shell's completion script
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
}

impl Command {
    /// Flags that every command has.
    pub(crate) fn common(&self) -> Option<&Common> {
        match self {
            Self::Simulate(a) => Some(&a.common),
            Self::Identify(a) => Some(&a.common),
            Self::Structure(a) => Some(&a.common),
            Self::Plan(a) => Some(&a.common),
            Self::Resimulate(a) => Some(&a.common),
            Self::Descend(a) => Some(&a.common),
            Self::Close(a) => Some(&a.common),
            Self::Study(a) => Some(&a.common),
            Self::Many(a) => Some(a.verb.common()),
            Self::Report(a) => Some(&a.common),
            Self::Verify(a) => Some(&a.common),
            Self::Check(a) => Some(&a.common),
            Self::Init(a) => Some(&a.common),
            Self::Explain(a) => Some(&a.common),
            Self::Manual { .. } | Self::Completions { .. } => None,
        }
    }
}

/// Flags of every command.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Common {
    /// Folder for results, made if missing; without it nothing is written (study and many need it)
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Overwrite results that exist
    #[arg(long)]
    pub(crate) force: bool,
    /// Print the result as JSON on standard output
    #[arg(long)]
    pub(crate) json: bool,
    /// Say nothing on standard error but errors and warnings
    #[arg(long)]
    pub(crate) quiet: bool,
    /// Number of threads [default: one per processor]; results do not depend on it
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<u16>,
}

fn threads(word: &str) -> Result<u16, String> {
    let what = || format!("allowed: a whole number from 1 to {MOST_THREADS}; try: leave it out, which takes one per processor");
    word.parse().ok().filter(|n| (1..=MOST_THREADS).contains(n)).ok_or_else(what)
}

/// `simulate`.
#[derive(Args, Debug)]
pub(crate) struct SimulateArgs {
    /// Scenario file (.toml) or bundled scenario: appendix-c, sage-unperturbed, sage-perturbed, sage-combined,
    /// sage-undeclared, sage-thesis, pole-push, drop-test, full-scale-venus-20km, glider-throws, venus-descent, venus-dispersions
    pub(crate) scenario: PathBuf,
    #[command(flatten)]
    pub(crate) request: windfall::Fly,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `identify`.
#[derive(Args, Debug)]
pub(crate) struct IdentifyArgs {
    /// Campaign file (.toml)
    pub(crate) campaign: PathBuf,
    #[command(flatten)]
    pub(crate) request: windfall::Identify,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `structure`.
#[derive(Args, Debug)]
pub(crate) struct StructureArgs {
    /// Campaign file (.toml)
    pub(crate) campaign: PathBuf,
    #[command(flatten)]
    pub(crate) request: windfall::Structure,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `plan`.
#[derive(Args, Debug)]
pub(crate) struct PlanArgs {
    /// Campaign file (.toml)
    pub(crate) campaign: PathBuf,
    #[command(flatten)]
    pub(crate) request: windfall::Plan,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `resimulate`.
#[derive(Args, Debug)]
pub(crate) struct ResimulateArgs {
    /// Campaign file (.toml)
    pub(crate) campaign: PathBuf,
    /// Result of `windfall identify`
    #[arg(long, value_name = "identification.json")]
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) request: windfall::Resimulate,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `descend`.
#[derive(Args, Debug)]
pub(crate) struct DescendArgs {
    /// Planet scenario of a rigid body: file (.toml), or bundled: venus-descent, venus-dispersions
    pub(crate) scenario: PathBuf,
    /// Result of `windfall identify`, of which all runs together are taken [default: the scenario's own coefficients, as if exact]
    #[arg(long, value_name = "identification.json")]
    pub(crate) model: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) request: windfall::Descend,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `close`.
#[derive(Args, Debug)]
pub(crate) struct CloseArgs {
    /// Campaign file (.toml), or a scenario, bundled (sage-undeclared) or by file (.toml): it is flown first, and its effects are not
    /// declared
    #[arg(required_unless_present = "statistics")]
    pub(crate) campaign: Option<PathBuf>,
    /// Published statistics (.toml), or table-5.6 for the bundled file, in place of a campaign
    #[arg(long, value_name = "FILE", conflicts_with = "campaign")]
    pub(crate) statistics: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) request: windfall::Close,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `study`.
#[derive(Args, Debug)]
pub(crate) struct StudyArgs {
    /// Study file (.toml)
    pub(crate) study: PathBuf,
    #[command(flatten)]
    pub(crate) request: windfall::Study,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `many`.
#[derive(Args, Debug)]
pub(crate) struct ManyArgs {
    #[command(subcommand)]
    pub(crate) verb: ManyVerb,
}

/// What is done to each campaign.
#[derive(Debug, Subcommand)]
pub(crate) enum ManyVerb {
    /// Close the loop of each
    Close(ManyOf<windfall::Close>),
    /// Identify each
    Identify(ManyOf<windfall::Identify>),
}

impl ManyVerb {
    fn common(&self) -> &Common {
        match self {
            Self::Close(a) => &a.common,
            Self::Identify(a) => &a.common,
        }
    }
}

/// `many close`, `many identify`.
#[derive(Args, Debug)]
pub(crate) struct ManyOf<R: Args> {
    /// Folders, searched for campaign.toml in them and their subfolders; or campaign files (.toml)
    #[arg(required = true, value_name = "FOLDER|CAMPAIGN")]
    pub(crate) paths: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) request: R,
    #[command(flatten)]
    pub(crate) many: windfall::Many,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `report`.
#[derive(Args, Debug)]
pub(crate) struct ReportArgs {
    /// Folder with close.json, identification.json, resimulation.json, verify.json, summary.json, many.json or descent.json
    pub(crate) folder: PathBuf,
    /// Also write every figure into this folder as SVG and PDF, and its data as CSV
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Width of those figures, mm: 86 is one column of most journals, 178 two
    #[arg(long, value_name = "MM", default_value_t = windfall::report::WIDTH_MM, requires = "figures", value_parser = width)]
    pub(crate) width: f64,
    #[command(flatten)]
    pub(crate) common: Common,
}

fn width(word: &str) -> Result<f64, String> {
    let [least, most] = windfall::FIGURE_WIDTHS_MM;
    let what = || format!("allowed: {least} to {most} mm");
    word.parse().ok().filter(|w| (least..=most).contains(w)).ok_or_else(what)
}

/// `verify`.
#[derive(Args, Debug)]
pub(crate) struct VerifyArgs {
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `check`.
#[derive(Args, Debug)]
pub(crate) struct CheckArgs {
    /// Campaign, scenario, structure (.toml) or run file (.csv, .parquet, .mat, .arrow, .h5), or a bundled scenario
    #[arg(required_unless_present = "keys")]
    pub(crate) file: Option<PathBuf>,
    /// Print every key of the files, with unit and range
    #[arg(long)]
    pub(crate) keys: bool,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `init`.
#[derive(Args, Debug)]
pub(crate) struct InitArgs {
    /// Folder for the campaign file, made if missing
    pub(crate) folder: PathBuf,
    /// Run files (.csv, .parquet, .mat, .arrow, .h5)
    #[arg(required = true, value_name = "RUN")]
    pub(crate) runs: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) request: windfall::Init,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `explain`.
#[derive(Args, Debug)]
pub(crate) struct ExplainArgs {
    #[command(flatten)]
    pub(crate) request: windfall::Explain,
    #[command(flatten)]
    pub(crate) common: Common,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    /// A verb without its function in Python is a verb forgotten there. Completions and manual pages are a shell's alone.
    #[test]
    fn law_python_has_every_verb() {
        let python = include_str!("../../python/py/windfall/__init__.py");
        let all = python.split_once("__all__ = [").and_then(|(_, rest)| rest.split_once(']')).expect("a list of names").0;
        let command = Cli::command();
        let verbs: Vec<&str> =
            command.get_subcommands().map(clap::Command::get_name).filter(|v| !["completions", "manual"].contains(v)).collect();
        assert!(verbs.len() > 10, "{verbs:?}");
        for verb in verbs {
            let there = python.contains(&format!("\ndef {verb}(")) && all.contains(&format!("\"{verb}\""));
            assert!(there, "windfall.{verb}: lacks its function, or its name in __all__");
        }
        let many = command.find_subcommand("many").expect("a verb");
        for each in many.get_subcommands().map(clap::Command::get_name) {
            assert!(python.contains(&format!("\ndef {each}(")), "windfall.many(\"{each}\")");
        }
    }

    /// A default is written once: what no flag says is what the request's `Default` says.
    #[test]
    fn law_no_flag_is_the_default() {
        let parse = |words: &[&str]| Cli::try_parse_from([&["windfall"], words].concat()).expect("right words").command;
        let Command::Simulate(a) = parse(&["simulate", "x"]) else { unreachable!("as typed") };
        assert_eq!(a.request, windfall::Fly::default());
        let Command::Identify(a) = parse(&["identify", "x"]) else { unreachable!("as typed") };
        assert_eq!(a.request, windfall::Identify::default());
        let Command::Structure(a) = parse(&["structure", "x"]) else { unreachable!("as typed") };
        assert_eq!(a.request, windfall::Structure::default());
        let Command::Plan(a) = parse(&["plan", "x", "--target", "Cm_2=5%"]) else { unreachable!("as typed") };
        assert!(a.request.between.total_cmp(&windfall::Plan::default().between).is_eq());
        let Command::Resimulate(a) = parse(&["resimulate", "x", "--model", "y"]) else { unreachable!("as typed") };
        assert_eq!(a.request, windfall::Resimulate::default());
        let Command::Descend(a) = parse(&["descend", "x"]) else { unreachable!("as typed") };
        assert_eq!(a.request, windfall::Descend::default());
        let Command::Study(a) = parse(&["study", "x"]) else { unreachable!("as typed") };
        assert_eq!(a.request, windfall::Study::default());
        let Command::Many(ManyArgs { verb: ManyVerb::Identify(a) }) = parse(&["many", "identify", "x", "y"]) else {
            unreachable!("as typed")
        };
        assert_eq!((a.request, a.many, a.paths.len()), (windfall::Identify::default(), windfall::Many::default(), 2));
        let Command::Identify(a) = parse(&["identify", "x", "--method", "filter-error"]) else { unreachable!("as typed") };
        assert_eq!(a.request.method, Some(windfall::Method::FilterError));
    }
}
