//! pid: the methods of identification, each once. In: a campaign and a method. Out: its declared parameters, per data set, with warnings.

use crate::PidError;
use crate::declared::with_effects;
use crate::equation_error::{EquationError, HONEST, JOINT, THESIS};
use crate::identification::Identification;
use crate::output_error::EstimateOptions;
use crate::smooth::{Smoother, TABLE_3_1_HZ};
use crate::{filter_error, output_error};
use serde::{Deserialize, Serialize};
use windfall_model::Campaign;

/// How to identify.
///
/// ```
/// use windfall_pid::Method;
/// assert_eq!(Method::of_name("output-error"), Some(Method::OutputError));
/// assert_eq!(Method::ALL.map(Method::name)[3], "filter-error");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Method {
    /// The thesis to the letter: Fourier smoothing with Table 3.1's cutoffs, C_N,T from the root of squares, white standard errors.
    Thesis,
    /// Equation error: spline smoothing, C_Y and C_N together, noise of the regressors corrected, standard errors for coloured residuals.
    EquationError,
    /// Output error: maximum likelihood on the measured poses and tunnel speed, trajectories integrated.
    OutputError,
    /// Filter error: maximum likelihood of a Kalman filter's innovations, turbulence estimated with the parameters.
    FilterError,
}

/// All that there is to say of one method; the table of them is what is iterated. A method more is a variant, a row and, where it is no
/// setting of another, a module; `just references` says it to the users.
struct Estimator {
    method: Method,
    name: &'static str,
    help: &'static str,
    smoother: Smoother,
    identify: fn(&Campaign, &EstimateOptions) -> Result<Identification, PidError>,
}

/// In the order of the variants.
const ESTIMATORS: &[Estimator] = &[
    Estimator {
        method: Method::Thesis,
        name: THESIS.name,
        help: "The thesis to the letter, its errors included",
        smoother: Smoother::Thesis { cutoffs_hz: TABLE_3_1_HZ },
        identify: |campaign, options| regressed(campaign, Method::Thesis, options),
    },
    Estimator {
        method: Method::EquationError,
        name: JOINT.name,
        help: "Joint side and normal force, ends handled, noise of the regressors corrected; what cannot be estimated is said",
        smoother: Smoother::Auto,
        identify: |campaign, options| regressed(campaign, Method::EquationError, options),
    },
    Estimator {
        method: Method::OutputError,
        name: "output-error",
        help: "Maximum likelihood of trajectories: right where sensors' noise is all there is",
        smoother: Smoother::Auto,
        identify: output_error::identify,
    },
    Estimator {
        method: Method::FilterError,
        name: "filter-error",
        help: "Maximum likelihood of a Kalman filter's innovations: right in turbulence, whose size and scale it estimates",
        smoother: Smoother::Auto,
        identify: filter_error::identify,
    },
];

impl Method {
    /// All of them.
    pub const ALL: [Self; ESTIMATORS.len()] = {
        let mut all = [Self::Thesis; ESTIMATORS.len()];
        let mut i = 0;
        while i < all.len() {
            all[i] = ESTIMATORS[i].method;
            i += 1;
        }
        all
    };
    const fn row(self) -> &'static Estimator {
        let at = self as usize;
        assert!(
            at < ESTIMATORS.len() && ESTIMATORS[at].method as usize == at,
            "ESTIMATORS has a row for each method, in the order of `Method`"
        );
        &ESTIMATORS[at]
    }
    /// The method of this name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }
    /// Name on the command line and in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.row().name
    }
    /// One line: what it is and where it is right.
    #[must_use]
    pub const fn help(self) -> &'static str {
        self.row().help
    }
    /// The smoother that belongs to the method.
    #[must_use]
    pub fn smoother(self) -> Smoother {
        self.row().smoother.clone()
    }
}

/// Identifies a campaign's declared parameters on the runs it has for that: on each kind of run alone and on all, `combined`.
///
/// # Errors
/// No usable run, a faulty record, fewer samples than parameters, or nothing that can be estimated. A parameter that the runs do
/// not excite is left out and named in the warnings.
pub fn identify(campaign: &Campaign, method: Method) -> Result<Identification, PidError> {
    identify_by(campaign, method, &EstimateOptions::default())
}

/// [`identify`], with options of the methods that integrate. Declared effects act with their declared values and are held there; a random one
/// that the method does not carry is a warning.
///
/// # Errors
/// As [`identify`]; [`PidError::OwnSmoothing`] for a smoother given to another method than the thesis'; [`PidError::NoPlace`] for ties and priors where a method regresses each coefficient by itself.
pub fn identify_by(campaign: &Campaign, method: Method, options: &EstimateOptions) -> Result<Identification, PidError> {
    if options.smoother.is_some() && method != Method::Thesis {
        return Err(PidError::OwnSmoothing { method: method.name() });
    }
    with_effects(campaign, method == Method::FilterError, |own| (method.row().identify)(own, options))
}

/// Each coefficient by itself.
fn regressed(campaign: &Campaign, method: Method, options: &EstimateOptions) -> Result<Identification, PidError> {
    if options.handling.is_empty() && options.priors.is_empty() {
        let smoother = options.smoother.clone().unwrap_or_else(|| method.smoother());
        let way = if method == Method::EquationError && !options.starting { HONEST } else { equation_error(method) };
        way.identify(campaign, &smoother, options.combined_only)
    } else {
        Err(PidError::NoPlace { method: method.name() })
    }
}

/// [`identify`] by regression, with another smoother and regressors taken as exact; a method that integrates counts as equation error here.
///
/// # Errors
/// As [`identify`].
pub fn identify_with(campaign: &Campaign, method: Method, smoother: &Smoother) -> Result<Identification, PidError> {
    with_effects(campaign, false, |own| equation_error(method).identify(own, smoother, false))
}

fn equation_error(method: Method) -> EquationError {
    EquationError { name: method.name(), ..if method == Method::Thesis { THESIS } else { JOINT } }
}

#[cfg(test)]
mod tests {
    use super::Method;

    /// What the reader of a request takes, by its own words, is what the list has.
    #[test]
    fn law_every_method_is_in_the_list() {
        let refused = serde_json::from_str::<Method>("\"none\"").expect_err("no method").to_string();
        let known = refused.split_once("expected one of ").map_or("", |(_, rest)| rest);
        let known: Vec<&str> = known.split('`').skip(1).step_by(2).collect();
        assert_eq!(known, Method::ALL.map(Method::name));
        // Rows are found by the variant's number.
        assert_eq!(Method::ALL.map(|m| m.row().method), Method::ALL);
    }
}
