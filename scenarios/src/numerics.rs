//! scenarios: the integrator's settings. In: the table of a scenario. Out: method and tolerances.

use crate::keys;
use crate::table::Table;
use windfall_model::{Integrator, Numerics};

/// Settings of `[numerics]`; what it does not say is as in `default`.
pub(crate) fn numerics(file: &Table<'_>, default: Numerics) -> Numerics {
    let Some(t) = file.table_if(&keys::NUMERICS) else { return default };
    Numerics {
        method: match t.has("method").then(|| t.choice("method")).flatten() {
            Some(0) => Integrator::Dopri5,
            Some(_) => Integrator::Dop853,
            None => default.method,
        },
        relative_tolerance: t.number_if("relative_tolerance").unwrap_or(default.relative_tolerance),
        absolute_tolerance: t.number_if("absolute_tolerance").unwrap_or(default.absolute_tolerance),
    }
}
