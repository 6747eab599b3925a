//! pid tests: output error on the shared campaigns of an independent simulator.

mod common;

use common::{campaign, truth};
use windfall_pid::{Method, identify};

#[test]
fn probe() {
    for name in ["open-00", "exact"] {
        let Some(c) = campaign("probe", name) else { return };
        let t = std::time::Instant::now();
        let found = identify(&c, Method::OutputError).expect("identifies");
        eprintln!("{name} {:?} {:?}", t.elapsed(), found.warnings);
        for d in found.data_sets.iter().filter(|d| d.name == "combined") {
            eprintln!("{} cond {:.2e}", d.name, d.condition_number);
            for p in &d.parameters {
                eprintln!(
                    "{} {} {:.5} se {:.2e} white {:.2e} z {:.2}",
                    p.coefficient,
                    p.name,
                    p.estimate,
                    p.std_error,
                    p.std_error_white,
                    (p.estimate - truth(&p.name)) / p.std_error
                );
            }
            for f in &d.fits {
                eprintln!("{} r2 {:.6} std {:.3e} p {:.3}", f.coefficient, f.r2, f.residual_std, f.residual_whiteness_p);
            }
        }
    }
}
