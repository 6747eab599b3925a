//! scratch
mod common;
use common::*;
use windfall_pid::smooth::*;
use windfall_pid::*;
fn show(id: &Identification) {
    for d in &id.data_sets {
        println!("== {} {:?} n={} cond={:.1}", d.name, d.runs, d.n_samples, d.condition_number);
        for p in &d.parameters {
            let t = truth(&p.name);
            println!(
                "{:3} {:8} {:12.5} truth {:10.4} rel {:10.2e}  se {:.2e} white {:.2e} z {:6.2} {}",
                p.coefficient,
                p.name,
                p.estimate,
                t,
                p.estimate / t - 1.0,
                p.std_error,
                p.std_error_white,
                (p.estimate - t) / p.std_error,
                if p.ci95[0] <= t && t <= p.ci95[1] { "" } else { "OUT" }
            );
        }
        for f in &d.fits {
            println!("   fit {} r2 {:.6} s {:.3e} p {:.2}", f.coefficient, f.r2, f.residual_std, f.residual_whiteness_p);
        }
    }
    for w in &id.warnings {
        println!("WARN {w}");
    }
}
#[test]
fn exact() {
    let c = campaign("x", "exact").unwrap();
    show(&identify(&c, Method::EquationError).unwrap());
    for k in [3.0, 4.0, 6.0] {
        println!("knot {k}");
        show(&identify_with(&c, Method::EquationError, &Smoother::Spline { knot_s: k / 150.0 }).unwrap());
    }
    for k in [4.0, 6.0, 8.0] {
        println!("local {k}");
        show(&identify_with(&c, Method::EquationError, &Smoother::Local { half_width_s: [k / 150.0; 7], degree: 8 }).unwrap());
    }
}
#[test]
fn thesis() {
    let c = campaign("x", "exact").unwrap();
    show(&identify(&c, Method::Thesis).unwrap());
    println!("unfiltered");
    show(&identify_with(&c, Method::Thesis, &Smoother::Thesis { cutoffs_hz: [f64::INFINITY; 7] }).unwrap());
    println!("auto");
    show(&identify_with(&c, Method::Thesis, &Smoother::ThesisAuto).unwrap());
}
#[test]
fn open() {
    let c = campaign("x", "open-00").unwrap();
    let t = std::time::Instant::now();
    let id = identify(&c, Method::EquationError).unwrap();
    println!("took {:?}", t.elapsed());
    for r in &c.runs {
        if let windfall_model::Data::Tunnel(r) = &r.data {
            let s = smooth(r, &Smoother::Auto).unwrap();
            println!(
                "bw {:.2} Hz noise {:?}",
                s.bandwidth_hz[0],
                s.noise_std.iter().zip(NOISE).map(|(a, b)| (a / b * 1000.0).round() / 1000.0).collect::<Vec<_>>()
            );
        }
    }
    show(&id);
}
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
pub fn noisy(r: &windfall_model::Record, seed: u64) -> windfall_model::Record {
    let mut r = r.clone();
    let mut g = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
    let nn = Normal::new(0.0, 1.0).unwrap();
    let mut add = |x: &mut Vec<f64>, s: f64| {
        for v in x.iter_mut() {
            let z: f64 = nn.sample(&mut g);
            *v += s * z;
        }
    };
    for k in 0..3 {
        add(&mut r.position_m[k], NOISE[k]);
        add(&mut r.attitude_rad[k], NOISE[3 + k]);
    }
    add(&mut r.vw_m_s, NOISE[6]);
    r
}
pub fn study(label: &str, sm: &Smoother, seeds: u64) {
    let c0 = campaign("x", "exact").unwrap();
    let windfall_model::Data::Tunnel(r) = &c0.runs[0].data else { panic!() };
    let mut acc: std::collections::BTreeMap<usize, (String, Vec<f64>, Vec<f64>, usize)> = Default::default();
    let mut bw = 0.0;
    for s in 0..seeds {
        let rr = noisy(r, s);
        bw += smooth(&rr, sm).unwrap().bandwidth_hz[0] / seeds as f64;
        let c = campaign_of("x", vec![("a".into(), "p".into(), windfall_model::Use::Identify, rr)]);
        let id = identify_with(&c, Method::EquationError, sm).unwrap();
        for (i, p) in id.data_sets[1].parameters.iter().enumerate() {
            let t = truth(&p.name);
            let e = acc.entry(i).or_insert((format!("{} {}", p.coefficient, p.name), vec![], vec![], 0));
            e.1.push(p.estimate - t);
            e.2.push(p.std_error);
            if p.ci95[0] <= t && t <= p.ci95[1] {
                e.3 += 1
            }
        }
    }
    println!("--- {label} bw {bw:.2}");
    for (_, (n, e, s, c)) in acc {
        let m = e.iter().sum::<f64>() / e.len() as f64;
        let sd = (e.iter().map(|x| (x - m).powi(2)).sum::<f64>() / e.len() as f64).sqrt();
        let se = s.iter().sum::<f64>() / s.len() as f64;
        println!(
            "{n:12} bias/sd {:6.2} sd {:.3e} se/sd {:.2} cover {:.0}%",
            m / sd,
            sd,
            se / sd,
            100.0 * c as f64 / e.len() as f64
        );
    }
}
#[test]
#[ignore = "mc"]
fn mc() {
    study("auto", &Smoother::Auto, 200);
    for k in [0.0; 0] {
        study(&format!("knot {k}"), &Smoother::Spline { knot_s: k / 150.0 }, 100);
    }
}
