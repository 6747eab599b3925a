//! scenarios: units that columns may come in. In: a word. Out: the factor and zero that make it the unit of our column.

/// What a column measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UnitQuantity {
    Time,
    Length,
    Angle,
    Pressure,
    Speed,
    Temperature,
    Acceleration,
}

/// A unit: ours is (value + `shift`) x `per` / `over`. Factors are those of BIPM, "The International System of Units", 9th edition, and
/// NIST SP 811 (2008), appendix B; all are exact; a millimetre of mercury is of 13595.1 kg/m3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColumnUnit {
    pub(crate) word: &'static str,
    shift: f64,
    per: f64,
    over: f64,
}

const fn unit(word: &'static str, per: f64, over: f64) -> ColumnUnit {
    ColumnUnit { word, shift: 0.0, per, over }
}

const TIME: &[ColumnUnit] =
    &[unit("s", 1.0, 1.0), unit("ms", 1.0, 1e3), unit("us", 1.0, 1e6), unit("ns", 1.0, 1e9), unit("min", 60.0, 1.0)];
const LENGTH: &[ColumnUnit] = &[
    unit("m", 1.0, 1.0),
    unit("mm", 1.0, 1e3),
    unit("cm", 1.0, 1e2),
    unit("um", 1.0, 1e6),
    unit("km", 1e3, 1.0),
    unit("in", 254.0, 1e4),
    unit("ft", 3048.0, 1e4),
];
const ANGLE: &[ColumnUnit] = &[
    unit("deg", 1.0, 1.0),
    unit("rad", 180.0, std::f64::consts::PI),
    unit("mrad", 0.18, std::f64::consts::PI),
    unit("turn", 360.0, 1.0),
];
/// Pounds per square foot and inch: 0.45359237 kg x 9.80665 m/s2 over 0.3048 m, 0.0254 m squared.
const PRESSURE: &[ColumnUnit] = &[
    unit("Pa", 1.0, 1.0),
    unit("hPa", 1e2, 1.0),
    unit("kPa", 1e3, 1.0),
    unit("MPa", 1e6, 1.0),
    unit("mbar", 1e2, 1.0),
    unit("bar", 1e5, 1.0),
    unit("atm", 101_325.0, 1.0),
    unit("mmHg", 13.5951 * 9.806_65, 1.0),
    unit("Torr", 101_325.0, 760.0),
    unit("psi", 0.453_592_37 * 9.806_65, 0.0254 * 0.0254),
    unit("psf", 0.453_592_37 * 9.806_65, 0.3048 * 0.3048),
];
const SPEED: &[ColumnUnit] = &[
    unit("m/s", 1.0, 1.0),
    unit("mm/s", 1.0, 1e3),
    unit("cm/s", 1.0, 1e2),
    unit("km/h", 1.0, 3.6),
    unit("ft/s", 3048.0, 1e4),
    unit("kn", 1852.0, 3600.0),
    unit("mph", 1609.344, 3600.0),
];
const TEMPERATURE: &[ColumnUnit] = &[
    unit("K", 1.0, 1.0),
    ColumnUnit { word: "degC", shift: 273.15, per: 1.0, over: 1.0 },
    ColumnUnit { word: "degF", shift: 459.67, per: 5.0, over: 9.0 },
    unit("degR", 5.0, 9.0),
];

/// Standard gravity is 9.80665 m/s2 by definition.
const ACCELERATION: &[ColumnUnit] = &[unit("m/s2", 1.0, 1.0), unit("g", 9.806_65, 1.0), unit("ft/s2", 3048.0, 1e4)];

impl UnitQuantity {
    const fn units(self) -> &'static [ColumnUnit] {
        match self {
            Self::Time => TIME,
            Self::Length => LENGTH,
            Self::Angle => ANGLE,
            Self::Pressure => PRESSURE,
            Self::Speed => SPEED,
            Self::Temperature => TEMPERATURE,
            Self::Acceleration => ACCELERATION,
        }
    }
    /// The unit of our column.
    pub(crate) const fn ours(self) -> ColumnUnit {
        self.units()[0]
    }
    /// All words, for messages.
    pub(crate) fn words(self) -> String {
        self.units().iter().map(|u| u.word).collect::<Vec<_>>().join(", ")
    }
}

impl ColumnUnit {
    pub(crate) fn of(quantity: UnitQuantity, word: &str) -> Option<Self> {
        quantity.units().iter().find(|u| u.word == word).copied()
    }
    pub(crate) fn ours(self, value: f64) -> f64 {
        (value + self.shift) * self.per / self.over
    }
    /// Bits that tell one unit from another of the same quantity.
    pub(crate) fn factor(self) -> (u64, u64) {
        ((self.per / self.over).to_bits(), self.shift.to_bits())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Printed equivalents: NIST SP 811, appendix B.8 (psi 6.894757E+03, psf 4.788026E+01, knot 5.144444E-01, mile per hour 4.4704E-01) and
    /// the fixed points of the scales; seven printed digits are half a unit in the last.
    #[test]
    fn pub_units_are_those_of_the_tables() {
        for (quantity, word, value, ours) in [
            (UnitQuantity::Pressure, "psi", 1.0, 6_894.757),
            (UnitQuantity::Pressure, "psf", 1.0, 47.880_26),
            (UnitQuantity::Pressure, "mmHg", 1.0, 133.322_4),
            (UnitQuantity::Speed, "kn", 1.0, 0.514_444_4),
            (UnitQuantity::Speed, "mph", 1.0, 0.447_04),
            (UnitQuantity::Length, "ft", 1.0, 0.3048),
            (UnitQuantity::Angle, "rad", 1.0, 57.295_78),
            (UnitQuantity::Angle, "mrad", 1000.0, 57.295_78),
            (UnitQuantity::Temperature, "degF", 32.0, 273.15),
            (UnitQuantity::Temperature, "degC", 100.0, 373.15),
            (UnitQuantity::Time, "ms", 1500.0, 1.5),
        ] {
            let unit = ColumnUnit::of(quantity, word).expect("a unit");
            let error: f64 = unit.ours(value) / ours - 1.0;
            assert!(error.abs() < 1e-7, "{word}: {error}");
        }
    }

    /// The reference lists every unit that is read.
    #[test]
    fn law_the_reference_names_all_units() {
        let all = [
            UnitQuantity::Time,
            UnitQuantity::Length,
            UnitQuantity::Angle,
            UnitQuantity::Pressure,
            UnitQuantity::Speed,
            UnitQuantity::Temperature,
            UnitQuantity::Acceleration,
        ];
        for quantity in all {
            assert!(crate::keys::COLUMN.meaning.contains(&format!(": {}.", quantity.words())), "{quantity:?}");
        }
    }
}
