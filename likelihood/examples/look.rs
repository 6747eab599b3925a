//! Looks beneath a search: every step of it on one campaign.
#![expect(clippy::print_stdout, reason = "an example prints")]
use windfall_likelihood::{Engine, discover};
use windfall_model::Use;

fn main() {
    for path in std::env::args().skip(1) {
        let t = std::time::Instant::now();
        let campaign = windfall_scenarios::read_campaign(std::path::Path::new(&path)).expect("a campaign");
        let used: Vec<usize> = (0..campaign.runs.len()).filter(|&i| campaign.runs[i].used == Use::Identify).collect();
        let mut engine = Engine::new(&campaign, &used).expect("tunnel runs");
        match discover(&mut engine) {
            Ok(d) => {
                if std::env::var_os("QUIET").is_none() {
                    d.log.iter().for_each(|l| println!("{l}"));
                }
                for set in d.sets.iter().take(5) {
                    println!("  {:.1} {}", set.gain, set.families.join("+"));
                }
                for (n, i) in d.after.numbers.iter().zip(0..) {
                    let sd = d.after.covariance[(i, i)].sqrt();
                    if let windfall_likelihood::Id::Member(m, p) = n.id {
                        let member = &d.after.model.members[m];
                        println!(
                            "  {} {} = {:.6} +- {:.6}",
                            member.effect.family, member.parameters[p].name, member.values[p], sd
                        );
                    }
                }
                for (n, i) in d.after.numbers.iter().zip(0..) {
                    if let windfall_likelihood::Id::Constant(c) = n.id {
                        let known = &engine.campaign().knowledge.constants[c];
                        let sd = d.after.covariance[(i, i)].sqrt();
                        println!("    {} {:+.2} +- {:.2} of its uncertainty", known.name(), n.value / known.std, sd / known.std);
                    }
                }
                if let Some(c) = &d.contest {
                    println!("  contest {:?} strongest {:.1}", c.families, c.strongest);
                    c.leads.iter().flat_map(|l| std::iter::once(l).chain(&l.rivals)).for_each(|l| {
                        println!("    {} over {}: {:.1} {:?}", l.channel, l.variable, l.gain, l.amplitudes);
                    });
                }
                d.lines.iter().filter(|l| !l.of_instrument).take(2).for_each(|l| {
                    println!("    line {} {:.2} Hz {:.1} {}", l.channel, l.line_hz.unwrap_or(0.0), l.gain, l.variable)
                });
                println!("  chi {:?}", d.after.channels.map(|c| (c[2] * 1000.0).round() / 1000.0));
                let names: Vec<String> = d.after.model.members.iter().map(|m| m.effect.family.to_owned()).collect();
                println!("{path}: [{}] chi {:.3} {:.1} s", names.join("+"), d.after.chi, t.elapsed().as_secs_f64());
            }
            Err(e) => println!("{path}: {e} {:.1} s", t.elapsed().as_secs_f64()),
        }
    }
}
