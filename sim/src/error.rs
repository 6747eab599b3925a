//! sim: what can go wrong in a flight. In: where and what. Out: messages that say what to try.

use thiserror::Error;

/// Errors of this room.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SimError {
    /// A number of the plant or the flight that cannot be flown.
    #[error("{what} is {value}; allowed: {allowed}; try: another value in the file, or of what it is compared with")]
    Setup {
        /// Which number, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        allowed: &'static str,
    },
    /// A part of the plant that the batch does not carry.
    #[error("{what} is not carried by the batch; fly it alone")]
    NotInBatch {
        /// Which part.
        what: &'static str,
    },
    /// Something became NaN or infinite.
    #[error("{what} is not finite near t = {t_s} s; look for zero airspeed, an unstable model or a number out of range there")]
    NotFinite {
        /// Which quantity.
        what: &'static str,
        /// Time of the run, s.
        t_s: f64,
    },
    /// The integrator's step became too small.
    #[error("step size underflow at t = {t_s} s; try a larger tolerance, or look for a jump in forces there")]
    StepTooSmall {
        /// Time of the run, s.
        t_s: f64,
    },
    /// The budget of steps is used up before the flight's end.
    #[error(
        "given up after {steps} steps, t = {t_s:.3e} s reached: the {what} changes by itself at {rate_per_s:.1e} 1/s there; look for a \
         parameter out of range that acts on it, or try a larger tolerance"
    )]
    TooManySteps {
        /// Steps taken.
        steps: u32,
        /// Time of the run, s.
        t_s: f64,
        /// Which part of the state departs fastest.
        what: &'static str,
        /// How fast it grows or decays by itself, 1/s.
        rate_per_s: f64,
    },
    /// A flight over a planet beyond the heights that its atmosphere has.
    #[error(
        "height {height_m} m at t = {t_s} s is outside the atmosphere, which goes from {low_m} to {high_m} m; try: a shorter flight, another \
         start, or an atmosphere file that reaches there"
    )]
    OutsideAtmosphere {
        /// When, s.
        t_s: f64,
        /// Geodetic height, m.
        height_m: f64,
        /// Lowest height that the atmosphere has, m.
        low_m: f64,
        /// Highest height, m.
        high_m: f64,
    },
    /// The body spins faster and faster.
    #[error("body rate above {limit_rad_s} rad/s at t = {t_s} s; look for a damping parameter of the wrong sign or size")]
    Runaway {
        /// The limit, rad/s.
        limit_rad_s: f64,
        /// Time of the run, s.
        t_s: f64,
    },
}
