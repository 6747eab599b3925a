//! Fits given members at given values: `probe CAMPAIGN "loose-mass=0.04,1.2,0.04,0.1+swirl=0.1"`.
//! `STEPS` of the environment: most steps of the climb (20). `HOLD`: a number of the first member that stays as it is.
#![expect(clippy::print_stdout, reason = "an example prints")]
use windfall_likelihood::{Engine, Member, Model};
use windfall_model::{CATALOGUE, Use};
fn main() {
    let mut args = std::env::args().skip(1);
    let path = args.next().expect("campaign");
    let campaign = windfall_scenarios::read_campaign(std::path::Path::new(&path)).expect("a campaign");
    let used: Vec<usize> = (0..campaign.runs.len()).filter(|&i| campaign.runs[i].used == Use::Identify).collect();
    let engine = Engine::new(&campaign, &used).expect("tunnel runs");
    for spec in args {
        let mut model = Model::declared(engine.campaign());
        for part in spec.split('+').filter(|s| !s.is_empty()) {
            let (name, values) = part.split_once('=').expect("name=values");
            let effect = CATALOGUE.iter().find(|e| e.family == name).expect("a family");
            let mut m = Member::null(effect, engine.campaign());
            for (k, v) in values.split(',').enumerate() {
                m.values[k] = v.parse().expect("a number");
            }
            model.members.push(m);
        }
        let steps = std::env::var("STEPS").ok().and_then(|s| s.parse().ok()).unwrap_or(20);
        let holding = std::env::var("HOLD").ok().and_then(|s| s.parse().ok());
        let engine = holding.map_or_else(|| engine.clone(), |i| engine.holding(windfall_likelihood::Id::Member(0, i)));
        match engine.climb(&model, true, steps) {
            Ok(f) => {
                println!(
                    "{spec}: LL {:.1} total {:.1} chi {:.3} {}",
                    f.log_likelihood,
                    f.total,
                    f.chi,
                    f.stop.words(windfall_pid::SearchKind::Likelihood)
                );
                println!("  channels {:?}", f.channels.iter().map(|c| (c[2] * 1e3).round() / 1e3).collect::<Vec<_>>());
                for (i, n) in f.numbers.iter().enumerate() {
                    let sd = f.covariance[(i, i)].sqrt();
                    match n.id {
                        windfall_likelihood::Id::Member(m, p) => println!(
                            "  {} {} = {:.6} +- {:.6}",
                            f.model.members[m].effect.family,
                            f.model.members[m].parameters[p].name,
                            f.model.members[m].values[p],
                            sd
                        ),
                        windfall_likelihood::Id::Declared(d) => print!(
                            "  {}={:.4}+-{:.4}",
                            engine.campaign().plant.aero.structure.parameters[d],
                            f.model.declared[d],
                            sd
                        ),
                        _ => {}
                    }
                }
                println!();
            }
            Err(d) => println!("{spec}: {}", d.words(engine.campaign())),
        }
    }
}
