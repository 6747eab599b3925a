//! model: the air of a planet over height. In: geometric height. Out: pressure, temperature, gas constant.

use super::{us_1976, venus};

/// State of the air at one height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Air {
    /// Static pressure, Pa.
    pub pressure_pa: f64,
    /// Static temperature, K.
    pub temperature_k: f64,
    /// Specific gas constant, J/(kg K); that of a gas that is not ideal includes its compressibility.
    pub gas_constant_j_kg_k: f64,
}

impl Air {
    /// Density, kg/m³.
    #[must_use]
    pub fn density_kg_m3(&self) -> f64 {
        self.pressure_pa / (self.gas_constant_j_kg_k * self.temperature_k)
    }
}

/// Which air.
///
/// ```
/// use windfall_model::planet::Atmosphere;
///
/// // Table I of the US Standard Atmosphere 1976: 0.41351 kg/m³ at 10 km.
/// assert!((Atmosphere::Us1976.at(10_000.0).density_kg_m3() - 0.413_51).abs() < 5e-6);
/// // Seiff and others (1985): 64.79 kg/m³ at the ground of Venus.
/// assert!((Atmosphere::Venus.at(0.0).density_kg_m3() - 64.79).abs() < 5e-3);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Atmosphere {
    /// The US Standard Atmosphere 1976, −5 to 86 km.
    Us1976,
    /// Venus at low latitudes, 0 to 72 km (Seiff and others 1985).
    Venus,
    /// A table.
    Table(AtmosphereTable),
}

impl Atmosphere {
    /// Lowest and highest height that it knows, m.
    #[must_use]
    pub fn range_m(&self) -> [f64; 2] {
        match self {
            Self::Us1976 => us_1976::RANGE_M,
            Self::Venus => venus::table().range_m(),
            Self::Table(t) => t.range_m(),
        }
    }
    /// The air at a geometric height, m; beyond the range that at its end.
    #[must_use]
    pub fn at(&self, height_m: f64) -> Air {
        let [low, high] = self.range_m();
        let height_m = height_m.clamp(low, high);
        match self {
            Self::Us1976 => us_1976::air(height_m),
            Self::Venus => venus::table().at(height_m),
            Self::Table(t) => t.at(height_m),
        }
    }
}

/// Air over height, two rows or more, heights ascending. Between rows temperature and gas constant are linear in height and pressure
/// is as in a layer in hydrostatic equilibrium under them: a power of the temperature, exponential where it is constant.
#[derive(Clone, Debug, PartialEq)]
pub struct AtmosphereTable {
    height_m: Vec<f64>,
    air: Vec<Air>,
}

impl AtmosphereTable {
    /// A table; `None` when it has fewer than two rows, heights that do not ascend, or a state that is not positive and finite.
    #[must_use]
    pub fn new(rows: Vec<(f64, Air)>) -> Option<Self> {
        let good = |a: &Air| [a.pressure_pa, a.temperature_k, a.gas_constant_j_kg_k].iter().all(|x| x.is_finite() && *x > 0.0);
        let (height_m, air): (Vec<f64>, Vec<Air>) = rows.into_iter().unzip();
        (height_m.len() >= 2 && height_m.windows(2).all(|w| w[0] < w[1]) && air.iter().all(good))
            .then_some(Self { height_m, air })
    }
    /// Rows: height (m) and air.
    pub fn rows(&self) -> impl Iterator<Item = (f64, Air)> {
        self.height_m.iter().copied().zip(self.air.iter().copied())
    }
    fn range_m(&self) -> [f64; 2] {
        [self.height_m[0], self.height_m[self.height_m.len() - 1]]
    }
    fn at(&self, height_m: f64) -> Air {
        let i = self.height_m.partition_point(|h| *h <= height_m).clamp(1, self.height_m.len() - 1);
        let (a, b) = (self.air[i - 1], self.air[i]);
        let x = (height_m - self.height_m[i - 1]) / (self.height_m[i] - self.height_m[i - 1]);
        let temperature_k = a.temperature_k + x * (b.temperature_k - a.temperature_k);
        let whole = (b.temperature_k / a.temperature_k).ln();
        // Part of the way in the logarithm of the temperature; of the height, where temperatures are alike.
        let part = if whole.abs() > 1e-9 { (temperature_k / a.temperature_k).ln() / whole } else { x };
        Air {
            pressure_pa: a.pressure_pa * (part * (b.pressure_pa / a.pressure_pa).ln()).exp(),
            temperature_k,
            gas_constant_j_kg_k: a.gas_constant_j_kg_k + x * (b.gas_constant_j_kg_k - a.gas_constant_j_kg_k),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table of the standard atmosphere's rows at its layer bounds gives the standard between them: it is piecewise of this form in
    /// geopotential height, whose square term over 1 km is 4e-6 of the pressure.
    #[test]
    fn law_table_of_the_standard_is_the_standard() {
        let table = AtmosphereTable::new((0..=80).map(|km| (f64::from(km) * 1e3, us_1976::air(f64::from(km) * 1e3))).collect());
        let table = Atmosphere::Table(table.expect("ascends"));
        for m in [120.0, 5432.1, 10_250.0, 15_500.0, 33_333.0, 60_700.0] {
            let (a, b) = (table.at(m), us_1976::air(m));
            // The layer from 11 to 12 km geometric straddles no bound of these heights.
            assert!((a.density_kg_m3() / b.density_kg_m3() - 1.0).abs() < 1e-4, "{m}: {a:?} {b:?}");
        }
        assert_eq!(table.at(81e3), table.at(80e3));
    }

    /// An isothermal layer is an exponential, a layer of constant lapse a power law: exact at mid-height.
    #[test]
    fn exact_isothermal_and_linear_layers() {
        let air = |p, t| Air { pressure_pa: p, temperature_k: t, gas_constant_j_kg_k: 200.0 };
        let table =
            AtmosphereTable::new(vec![(0.0, air(1e5, 300.0)), (1e3, air(4e4, 300.0)), (2e3, air(1e4, 150.0))]).expect("good");
        assert!((table.at(500.0).pressure_pa - (1e5_f64 * 4e4).sqrt()).abs() < 1e-9);
        let exponent = 4_f64.ln() / 2_f64.ln();
        assert!((table.at(1500.0).pressure_pa / (4e4 * (225.0_f64 / 300.0).powf(exponent)) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn law_tables_that_cannot_be_are_refused() {
        let air = Air { pressure_pa: 1e5, temperature_k: 300.0, gas_constant_j_kg_k: 287.0 };
        for rows in [vec![(0.0, air)], vec![(1.0, air), (1.0, air)], vec![(0.0, air), (1.0, Air { temperature_k: 0.0, ..air })]] {
            assert!(AtmosphereTable::new(rows).is_none());
        }
    }
}
