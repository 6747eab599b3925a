//! verify: draws of the closing study. In: a family, a size, a seed. Out: a campaign flown with it, and what the loop says.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use windfall_model::{Acts, CATALOGUE, Campaign, Effect, Plant, Role, Use};
use windfall_scenarios::{ScenarioFile, read_bundled};
use windfall_sim::{Seed, fly};
use windfall_verify::campaign_of;
use windfall_verify::close::{Closing, Options, Verdict, close, declared};
use windfall_verify::trace::{Evidence, Fit, Instance, Problem, Weighing};

mod table;
pub(crate) use table::report;

/// How large a planted effect is, in units of what the same flights without it can see (1.96 standard errors).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Size {
    /// Half: below detection.
    Hidden,
    /// Two and a half.
    Small,
    /// Six.
    Large,
}

impl Size {
    fn units(self) -> f64 {
        match self {
            Self::Hidden => 0.5,
            Self::Small => 2.5,
            Self::Large => 6.0,
        }
    }
}

/// One draw of the study.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Draw {
    /// Families planted; none for a campaign with nothing in it.
    pub(crate) families: Vec<String>,
    /// How large.
    pub(crate) size: Size,
    /// Seed of form, sizes and noise.
    pub(crate) seed: u64,
    /// Place of the first family in the catalogue.
    pub(crate) place: usize,
}

/// All draws: `seeds` per family and size, `nulls`, `pairs` per pair of turbulence and another, `hidden` per family.
pub(crate) fn draws(seeds: u64, nulls: u64, pairs: u64, hidden: u64) -> Vec<Draw> {
    let families: Vec<&str> = CATALOGUE.iter().filter(|e| e.acts.on(Acts::Lander)).map(|e| e.family).collect();
    let draw = |families: &[&str], place: usize, size: Size, seed: u64| Draw {
        families: families.iter().map(|f| (*f).to_owned()).collect(),
        size,
        seed,
        place,
    };
    let mut all: Vec<Draw> = (0..nulls).map(|s| draw(&[], 0, Size::Large, s)).collect();
    for seed in 0..seeds {
        for (place, f) in families.iter().enumerate() {
            all.extend([Size::Large, Size::Small].map(|size| draw(&[f], place, size, seed)));
        }
    }
    // The ten partners are spread over the catalogue.
    let others: Vec<&str> =
        families.iter().copied().filter(|f| *f != "turbulence").step_by(families.len() / 10).take(10).collect();
    for seed in 0..pairs {
        all.extend(others.iter().map(|f| draw(&["turbulence", f], 0, Size::Large, seed)));
    }
    for seed in 0..hidden {
        all.extend(families.iter().enumerate().map(|(place, f)| draw(&[f], place, Size::Hidden, seed)));
    }
    all
}

/// One number put in, and what came out.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Number {
    pub(crate) family: String,
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) strength: bool,
    pub(crate) truth: f64,
    /// Estimate and standard error when the family was named.
    pub(crate) found: Option<(f64, f64)>,
    /// Upper bound when it was not.
    pub(crate) bound: Option<f64>,
}

/// What came of a draw.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Planted {
    pub(crate) draw: Draw,
    pub(crate) verdict: String,
    /// Families in the order they were added, each with its rivals.
    pub(crate) named: Vec<(String, Vec<String>)>,
    pub(crate) unexplained: usize,
    pub(crate) numbers: Vec<Number>,
    /// Shifts of declared parameters against the truth, in their standard errors.
    pub(crate) declared_z: Vec<f64>,
    pub(crate) error: Option<String>,
}

impl Planted {
    /// Every planted family is named or a rival of one that is; nothing is named where nothing is.
    pub(crate) fn right(&self) -> bool {
        let known = |f: &String| self.named.iter().any(|(n, rivals)| n == f || rivals.contains(f));
        match self.draw.families.as_slice() {
            [] => self.named.is_empty() && self.error.is_none(),
            [one] => self.named.first().is_some_and(|(n, rivals)| n == one || rivals.contains(one)),
            both => both.iter().all(known),
        }
    }
}

/// Flights whose model is known, ready to say what can be seen in them.
struct Sight<'a> {
    weighing: &'a Weighing<'a>,
    proof: &'a dyn Evidence,
    plant: &'a Plant,
}

impl Sight<'_> {
    /// A form and sizes of a family: forms are drawn until one can be seen within its range; `None` when none can.
    fn instance(&self, family: &str, size: Size, rng: &mut ChaCha8Rng) -> Option<Instance> {
        let effect = CATALOGUE.iter().find(|e| e.family == family && e.acts.on(Acts::Lander)).expect("of the catalogue");
        (0..30).find_map(|_| self.sized(effect, size, rng))
    }

    fn sized(&self, effect: &'static Effect, size: Size, rng: &mut ChaCha8Rng) -> Option<Instance> {
        let mut form = Instance::null(effect, self.plant, &[]);
        let margin_s = self.proof.margin_s();
        let (runs, durations) = (self.proof.run_indices(), self.proof.durations_s());
        let mut run = 0;
        for i in 0..form.values.len() {
            form.values[i] = match form.parameters[i].role {
                Role::Strength => 0.0,
                Role::Shape(tried) => between(tried, rng),
                Role::Run => {
                    run = rng.random_range(0..runs.len());
                    runs[run] as f64
                }
                Role::Instant => rng.random_range(margin_s..durations[run] - margin_s - 0.5),
            };
        }
        let units = self.weighing.visible(&form)?;
        let mut direction: Vec<f64> = units.iter().map(|_| StandardNormal.sample(rng)).collect();
        let norm = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        direction.iter_mut().for_each(|x| *x /= norm);
        for ((i, unit), d) in units.iter().zip(direction) {
            let p = &form.parameters[*i];
            let v = size.units() * unit * if p.low < 0.0 { d } else { d.abs() };
            if v < p.low || v > p.high {
                return None;
            }
            form.values[*i] = v;
        }
        Some(form)
    }
}

/// What every draw shares.
pub(crate) struct Study {
    file: ScenarioFile,
    options: Options,
    null: Sight<'static>,
}

impl Study {
    pub(crate) fn new() -> Self {
        let mut file = read_bundled("sage-undeclared").expect("bundled");
        file.scenario.plant = file.declared_plant.clone();
        // Two perturbed runs and half an unperturbed one to identify on, one perturbed run held out.
        file.scenario.flights.truncate(4);
        file.scenario.flights[2].duration_s = 20.0;
        let options = Options { flights: 0, ..Options::default() };
        // Kept until the program ends.
        let null: &'static Campaign = Box::leak(Box::new(campaign(&file, &file.declared_plant, 1_000_000).expect("it flies")));
        let (proof, fit) = declared(null, &options).expect("a campaign without effects is fitted");
        let (proof, fit): (&'static dyn Evidence, &'static Fit) = (Box::leak(proof), Box::leak(Box::new(fit)));
        let weighing = Weighing::new(Box::leak(Box::new(problem(null, proof))), fit).expect("and can be weighed");
        Self { file, options, null: Sight { weighing: Box::leak(Box::new(weighing)), proof, plant: &null.plant } }
    }

    /// Forms of a draw's families. What the second must exceed is what can be seen where the first acts.
    fn forms(&self, draw: &Draw) -> Option<Vec<Instance>> {
        let mut rng = ChaCha8Rng::seed_from_u64(draw.seed);
        rng.set_stream(draw.place as u64 * 8 + draw.families.len() as u64 * 2 + draw.size as u64);
        let Some(first) = draw.families.first() else { return Some(Vec::new()) };
        let mut forms = vec![self.null.instance(first, draw.size, &mut rng)?];
        if let Some(second) = draw.families.get(1) {
            let mut plant = self.file.declared_plant.clone();
            (forms[0].effect.apply)(&mut plant, &forms[0].values);
            let one = campaign(&self.file, &plant, 2_000_000 + draw.seed)?;
            let (proof, fit) = declared(&one, &self.options).ok()?;
            let problem = problem(&one, proof.as_ref());
            let weighing = Weighing::new(&problem, &fit)?;
            let sight = Sight { weighing: &weighing, proof: proof.as_ref(), plant: &one.plant };
            forms.push(sight.instance(second, draw.size, &mut rng)?);
        }
        Some(forms)
    }

    /// Flies a draw and closes the loop on it.
    pub(crate) fn close(&self, draw: &Draw) -> Planted {
        let nothing = |verdict: &str, error: Option<String>| Planted {
            draw: draw.clone(),
            verdict: verdict.to_owned(),
            named: Vec::new(),
            unexplained: 0,
            numbers: Vec::new(),
            declared_z: Vec::new(),
            error,
        };
        let Some(forms) = self.forms(draw) else { return nothing(OUT_OF_RANGE, None) };
        let mut plant = self.file.declared_plant.clone();
        for f in &forms {
            (f.effect.apply)(&mut plant, &f.values);
        }
        let seed = draw.place as u64 * 1000 + draw.seed + 100_000 * (draw.families.len() as u64 + 4 * draw.size as u64);
        let Some(flown) = campaign(&self.file, &plant, seed) else { return nothing(OUT_OF_RANGE, None) };
        // Copies of their own, so that what chance does to one set of them is not common to all draws.
        match close(&flown, &Options { seed, ..self.options }) {
            Ok(c) => said(draw, &forms, &self.file.declared_plant, &c),
            Err(e) => nothing("error", Some(e.to_string())),
        }
    }
}

/// Verdict of a draw whose family cannot be seen at such a size in these flights within its range, or makes them fail: not flown.
pub(crate) const OUT_OF_RANGE: &str = "out of range";

fn problem<'a>(campaign: &'a Campaign, evidence: &'a dyn Evidence) -> Problem<'a> {
    Problem { evidence, base: &campaign.plant, declared: &campaign.declared, inputs: &[] }
}

/// Log-uniform between the smallest and largest value tried; uniform where they change sign; whole where all are whole.
fn between(tried: &[f64], rng: &mut ChaCha8Rng) -> f64 {
    let (low, high) = tried.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    let u: f64 = rng.random();
    if tried.len() > 2 && tried.iter().all(|x| x.fract() == 0.0) {
        tried[rng.random_range(0..tried.len())]
    } else if low > 0.0 {
        low * (high / low).powf(u)
    } else {
        low + (high - low) * u
    }
}

/// A campaign of a plant; `None` when it cannot be flown, as with strong negative damping.
fn campaign(file: &ScenarioFile, plant: &Plant, seed: u64) -> Option<Campaign> {
    let one = |(i, flight): (usize, &_)| fly(&plant.for_run(i, &[]), flight, Seed { campaign: seed, run: i as u64 });
    let flown: Vec<_> = file.scenario.flights.par_iter().enumerate().map(one).collect();
    let records: Vec<_> =
        file.scenario.flights.iter().zip(flown).map(|(f, r)| Some((f, r.ok()?.record))).collect::<Option<_>>()?;
    let mut campaign = campaign_of(&file.declared_plant, &records);
    campaign.plant.clone_from(&file.declared_plant);
    campaign.declared.clone_from(&file.declared);
    campaign.runs.retain(|r| r.used == Use::Identify || r.used == Use::HoldOut);
    Some(campaign)
}

fn said(draw: &Draw, forms: &[Instance], truth: &Plant, c: &Closing) -> Planted {
    let numbers = forms
        .iter()
        .flat_map(|f| {
            f.parameters.iter().zip(&f.values).filter(|(p, _)| p.role != Role::Run).map(|(p, v)| {
                let own = c.effects.iter().find(|e| e.family == f.effect.family);
                let line = own.and_then(|e| e.parameters.iter().find(|q| q.name == p.name));
                let bound = c.bounds.iter().find(|b| b.family == f.effect.family && b.parameter == p.name);
                Number {
                    family: f.effect.family.to_owned(),
                    name: p.name.clone(),
                    unit: p.unit.to_owned(),
                    strength: p.role == Role::Strength,
                    truth: *v,
                    found: line.and_then(|l| Some((l.estimate, l.std_error?))),
                    bound: bound.map(|b| b.upper95),
                }
            })
        })
        .collect();
    let z = |s: &windfall_verify::close::Shift| Some((s.after - truth.aero.value(&s.name)?) / s.std_error_after);
    Planted {
        draw: draw.clone(),
        verdict: match c.verdict {
            Verdict::Consistent => "consistent",
            Verdict::Effect => "effect",
            Verdict::Unexplained => "unexplained",
        }
        .to_owned(),
        named: c.effects.iter().map(|e| (e.family.clone(), e.rivals.clone())).collect(),
        unexplained: c.unexplained.len(),
        numbers,
        declared_z: c.shifts.iter().filter_map(z).filter(|z| z.is_finite()).collect(),
        error: None,
    }
}
