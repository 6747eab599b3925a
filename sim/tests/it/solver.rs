//! sim tests: the library's integrators where they need care. In: a sine. Out: what goes wrong without that care.

use nalgebra::Vector2;
use ode_solvers::{Dop853, System};

/// `ẋ = cos t` beside a clock: with the library's own time, or with the clock.
struct Cosine {
    clock: bool,
}

impl System<f64, Vector2<f64>> for Cosine {
    fn system(&self, t: f64, y: &Vector2<f64>, dy: &mut Vector2<f64>) {
        *dy = Vector2::new(if self.clock { y[1] } else { t }.cos(), 1.0);
    }
}

/// Largest error of `x = sin t` over two turns; infinite when the integrator gives up.
fn error(clock: bool) -> f64 {
    let mut solver = Dop853::new(Cosine { clock }, 0.0, 12.05, 0.1, Vector2::zeros(), 1e-10, 1e-12);
    match solver.integrate() {
        Ok(_) => solver
            .x_out()
            .iter()
            .zip(solver.y_out())
            .map(|(t, y)| (y[0] - t.sin()).abs())
            .max_by(f64::total_cmp)
            .unwrap_or(f64::NAN),
        Err(_) => f64::INFINITY,
    }
}

/// The eighth-order method is right only with time carried as a state, as every flight here does. Should the second assertion
/// fall, the library has been mended, and the clock may go. Bounds: tolerance times ten; four orders above the tolerance.
#[test]
fn law_time_is_carried_as_a_state() {
    assert!(error(true) < 1e-9, "{}", error(true));
    assert!(error(false) > 1e-6, "{}", error(false));
}
