//! cli: the words of the command line. In: arguments. Out: commands as typed.

use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use windfall_scenarios::Shard;

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
    /// Find what the declared model lacks: residual, effect, its numbers, errors before and after
    ///
    /// Exit code 1 when the residual is beyond noise and no effect of the catalogue accounts for it (verdict "unexplained"); 0 when it
    /// is noise ("consistent") or was explained ("effect").
    Close(CloseArgs),
    /// Many draws around a scenario or campaign: what a test will tell
    ///
    /// The same bits on any number of threads, in shards, or resumed after a kill. Parts are kept in DIR/parts until all are there.
    Study(StudyArgs),
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
            Self::Structure(a) => Some(&a.common),
            Self::Plan(a) => Some(&a.common),
            Self::Resimulate(a) => Some(&a.common),
            Self::Close(a) => Some(&a.common),
            Self::Study(a) => Some(&a.common),
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
    /// Check the stated errors by N copies: the identified model is flown again with the campaign's own inputs and noise, and identified
    /// again; scatter over stated error is known to 1/√(2N)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(2..))]
    pub(crate) bootstrap: Option<u16>,
    /// Hold a parameter: it is not estimated but kept at this value (Cl_0=0.0125); may be repeated
    #[arg(long, value_name = "NAME=VALUE", value_parser = crate::knowledge::hold)]
    pub(crate) hold: Vec<windfall_pid::Held>,
    /// Tie a parameter to another: both are one unknown (Cn_1=Cm_1: pitch and yaw damping shared); methods that integrate; may be
    /// repeated
    #[arg(long, value_name = "NAME=NAME", value_parser = crate::knowledge::tie)]
    pub(crate) tie: Vec<windfall_verify::Tie>,
    /// What is known of a parameter beforehand: mean and standard deviation (Cl_p=-5.7±0.3 or Cl_p=-5.7:0.3); methods that integrate;
    /// may be repeated
    #[arg(long, value_name = "NAME=MEAN±STD", value_parser = crate::knowledge::prior)]
    pub(crate) prior: Vec<windfall_pid::output_error::Prior>,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// `structure`.
#[derive(Args, Debug)]
pub(crate) struct StructureArgs {
    /// Campaign file (.toml)
    pub(crate) campaign: PathBuf,
    /// By which terms are chosen: likelihood (trajectories and gusts), subset or f or agreed (regression, residuals of any colour), bic,
    /// pse, press, cross-validation; white-f and white-pse take residuals as white
    #[arg(long, value_name = "NAME", default_value = "likelihood", value_parser = crate::structure::criterion)]
    pub(crate) criterion: windfall_pid::structure::Criterion,
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
    /// Also fly N models with parameters drawn from their covariance: 95 % bands on Θ and ω_q,r, intervals of the statistics; 40 to
    /// 200 are enough, 0 is none
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) draws: u16,
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

/// `study`.
#[derive(Args, Debug)]
pub(crate) struct StudyArgs {
    /// Study file (.toml)
    pub(crate) study: PathBuf,
    /// Go on with the draws that another run of this study left in the folder
    #[arg(long, conflicts_with = "force")]
    pub(crate) resume: bool,
    /// Draw share i of n only, i from 1 to n; when all shares are there, --resume without --shard joins them
    #[arg(long, value_name = "i/n", value_parser = shard, conflicts_with = "force")]
    pub(crate) shard: Option<Shard>,
    #[command(flatten)]
    pub(crate) common: Common,
}

fn shard(word: &str) -> Result<Shard, String> {
    let parts = word.split_once('/').and_then(|(i, n)| Some((i.parse::<u64>().ok()?, n.parse::<u64>().ok()?)));
    match parts {
        Some((i, of)) if i >= 1 && i <= of => Ok(Shard { index: i - 1, of }),
        _ => Err("must be i/n with whole numbers and i from 1 to n, e.g. 1/8".to_owned()),
    }
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
