//! pid bench: time of output error and filter error against the length of the data, one thread: the shared campaign's runs once, four
//! and sixteen times over (67 s, 268 s, 1,072 s), each with noise of its own, and its longest run cut to a quarter, half and whole. Linear
//! is the claim; the machine's noise is in the figures.
#[path = "../tests/common/mod.rs"]
mod common;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::time::Instant;
use windfall_model::{Campaign, Data, Use};
use windfall_pid::output_error::EstimateOptions;
use windfall_pid::{Identification, PidError, filter_error, output_error};

type Identify = fn(&Campaign, &EstimateOptions) -> Result<Identification, PidError>;

/// Size of the noise that every repetition has of its own, over the sensors'.
const OWN: f64 = 3.0;

/// The runs so many times over, each with noise of its own above theirs: sixteen records of the same noise would have one chance residual
/// sixteen times, which is then no noise, and errors for coloured residuals would be asked for.
fn repeated(campaign: &Campaign, times: usize) -> Campaign {
    let mut out = campaign.clone();
    out.runs.retain(|r| r.used == Use::Identify);
    out.runs = out.runs.iter().cycle().take(times * out.runs.len()).cloned().collect();
    let std = out.plant.sensors.std_by_channel();
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for run in &mut out.runs {
        let Data::Tunnel(record) = &mut run.data else { continue };
        for (channel, std) in record.channels_mut().into_iter().zip(std) {
            channel.iter_mut().for_each(|x| *x += OWN * std * Distribution::<f64>::sample(&StandardNormal, &mut rng));
        }
    }
    out
}

/// The longest run alone, cut to a part of its length.
fn cut(campaign: &Campaign, part: f64) -> Campaign {
    let mut out = campaign.clone();
    out.runs.retain(|r| r.name == "unperturbed-1");
    for run in &mut out.runs {
        let Data::Tunnel(r) = &mut run.data else { continue };
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive number of samples")]
        let n = (part * r.t_s.len() as f64) as usize;
        *r = r.rows(&(0..n));
    }
    out
}

fn seconds(identify: Identify, campaign: &Campaign) -> f64 {
    let began = Instant::now();
    let options = EstimateOptions { combined_only: true, ..EstimateOptions::default() };
    if let Err(e) = identify(campaign, &options) {
        eprintln!("  {e}");
    }
    began.elapsed().as_secs_f64()
}

fn report(what: &str, lengths: &[(&str, f64)]) {
    let first = lengths.first().map_or(f64::NAN, |l| l.1);
    let words: Vec<String> = lengths.iter().map(|(l, s)| format!("{l}: {s:.2} s ({:.2} × the first)", s / first)).collect();
    eprintln!("{what}: {}", words.join(", "));
}

fn main() {
    for (what, identify, name) in
        [("output error", output_error::identify as Identify, "open-00"), ("filter error", filter_error::identify, "open-03")]
    {
        let Some(campaign) = common::campaign("bench output_error", name) else { return };
        let times: &[(&str, usize)] =
            if name == "open-00" { &[("x1", 1), ("x4", 4), ("x16", 16)] } else { &[("x1", 1), ("x4", 4)] };
        let runs: Vec<_> = times.iter().map(|(l, n)| (*l, seconds(identify, &repeated(&campaign, *n)))).collect();
        report(&format!("{what}, {name}, more runs"), &runs);
        let parts = [("10 s", 0.25), ("20 s", 0.5), ("40 s", 1.0)];
        let lengths: Vec<_> = parts.iter().map(|(l, p)| (*l, seconds(identify, &cut(&campaign, *p)))).collect();
        report(&format!("{what}, {name}, a longer run"), &lengths);
    }
}
