//! cli: the words of the command line. In: arguments. Out: commands as typed.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;

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
    /// How much more tunnel time, from which release angle, brings a parameter's error where it is wanted
    Plan(PlanArgs),
    /// Fly the identified model against each run
    Resimulate(ResimulateArgs),
    /// Find what the declared model lacks: residual, effect, its numbers, errors before and after
    ///
    /// Exit code 1 when the residual is beyond noise and no effect of the catalogue accounts for it (verdict "unexplained"); 0 when it
    /// is noise ("consistent") or was explained ("effect").
    Close(CloseArgs),
    /// The page for a folder of results
    Report(ReportArgs),
    /// Every check of the program's own truth; figure beside bound
    Verify(VerifyArgs),
    /// Read a file, validate it and print what was understood
    Check(CheckArgs),
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
            Self::Plan(a) => Some(&a.common),
            Self::Resimulate(a) => Some(&a.common),
            Self::Close(a) => Some(&a.common),
            Self::Report(a) => Some(&a.common),
            Self::Verify(a) => Some(&a.common),
            Self::Check(a) => Some(&a.common),
            Self::Completions { .. } => None,
        }
    }
}

/// Flags of every command.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Common {
    /// Folder for results, made if missing [default: the current one; with --json alone nothing is written]
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
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) threads: Option<u16>,
}

/// `simulate`.
#[derive(Args, Debug)]
pub(crate) struct SimulateArgs {
    /// Scenario file (.toml) or bundled scenario: appendix-c, sage-unperturbed, sage-perturbed, sage-combined,
    /// sage-undeclared, drop-test, full-scale-venus-20km
    pub(crate) scenario: PathBuf,
    /// Seed of all chance, in place of the scenario's
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// How to identify.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum MethodWord {
    /// The thesis to the letter, its errors included
    Thesis,
    /// Joint side and normal force, ends handled, errors for coloured residuals
    EquationError,
    /// Maximum likelihood of trajectories: right where sensors' noise is all there is
    OutputError,
    /// Maximum likelihood of a Kalman filter's innovations: right in turbulence, whose size and scale it estimates
    FilterError,
}

/// `identify`.
#[derive(Args, Debug)]
pub(crate) struct IdentifyArgs {
    /// Campaign file (.toml)
    pub(crate) campaign: PathBuf,
    /// How to identify [default: output-error where its residual is noise, filter-error where process noise is found; the result says
    /// which and why]
    #[arg(long, value_enum)]
    pub(crate) method: Option<MethodWord>,
    /// Only all runs together, without each kind of run alone (methods that integrate)
    #[arg(long)]
    pub(crate) combined: bool,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `plan`.
#[derive(Args, Debug)]
pub(crate) struct PlanArgs {
    /// Campaign file (.toml)
    pub(crate) campaign: PathBuf,
    /// Parameter and wanted standard error, in percent of its estimate (Cm_2=5%) or in its unit (Cm_2=10); may be repeated
    #[arg(long, value_name = "PARAMETER=ERROR", required = true, value_parser = crate::plan::target)]
    pub(crate) target: Vec<windfall_pid::plan::Target>,
    /// Time between runs that counts as tunnel time, s
    #[arg(long, value_name = "S", default_value_t = 60.0, value_parser = crate::plan::seconds)]
    pub(crate) between: f64,
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
    /// Number of seeds over which simulated statistics are averaged
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) seeds: u16,
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
    pub(crate) common: Common,
}

/// `report`.
#[derive(Args, Debug)]
pub(crate) struct ReportArgs {
    /// Folder with close.json, identification.json, resimulation.json or verify.json
    pub(crate) folder: PathBuf,
    #[command(flatten)]
    pub(crate) common: Common,
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
    /// Campaign, scenario, structure (.toml) or run file (.csv), or a bundled scenario
    #[arg(required_unless_present = "keys")]
    pub(crate) file: Option<PathBuf>,
    /// Print every key of the files, with unit and range
    #[arg(long)]
    pub(crate) keys: bool,
    #[command(flatten)]
    pub(crate) common: Common,
}
