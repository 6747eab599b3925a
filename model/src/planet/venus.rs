//! model: a reference atmosphere of Venus. In: the printed table beside this file. Out: the table over height.
//!
//! Source: Seiff and others, Advances in Space Research 5(11), 1985, 3-58 (Venus International Reference Atmosphere), latitudes 0 to 30°.
//! Carbon dioxide at 92 bar is no ideal gas: the gas constant of each row is the one that gives the printed density.

use super::{Air, AtmosphereTable};
use std::sync::OnceLock;

/// As printed, in km, K, bar and kg/m³; its first lines name the source.
const PRINTED: &str = include_str!("venus-1985.csv");

/// The table.
pub(super) fn table() -> &'static AtmosphereTable {
    static TABLE: OnceLock<AtmosphereTable> = OnceLock::new();
    TABLE.get_or_init(|| {
        let rows = rows().map(|[km, kelvin, bar, density]| {
            let pressure_pa = bar * 1e5;
            (km * 1e3, Air { pressure_pa, temperature_k: kelvin, gas_constant_j_kg_k: pressure_pa / (density * kelvin) })
        });
        AtmosphereTable::new(rows.collect()).expect("the file beside this one ascends and is positive, as a test reads it")
    })
}

/// Height (km), temperature (K), pressure (bar), density (kg/m³).
fn rows() -> impl Iterator<Item = [f64; 4]> {
    let number = |cell: &str| cell.parse().unwrap_or(f64::NAN);
    PRINTED.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit())).map(move |line| {
        let mut cells = line.split(',').map(number);
        std::array::from_fn(|_| cells.next().unwrap_or(f64::NAN))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A slipped digit would break the balance of weight and pressure, `−d ln p/dh = ρ g/p`, with μ and radius of Venus (Konopliv and
    /// others 1999). Bound: 1.5e-2; the source's own rows balance to 1.2e-2 (gravity and radius of the reduction, density of a gas that is not ideal), and a
    /// wrong third digit shows as 5e-2 or more, for pressure falls by 6 to 20 % in 1 km.
    #[test]
    fn law_printed_rows_carry_their_own_weight() {
        let rows: Vec<[f64; 4]> = rows().collect();
        assert_eq!(rows.len(), 67);
        let gravity = |km: f64| 3.248_585_92e14 / (6_051.0e3 + km * 1e3).powi(2);
        for w in rows.windows(2) {
            let ([h0, _, p0, d0], [h1, _, p1, d1]) = (w[0], w[1]);
            let fall = (p0 / p1).ln() / ((h1 - h0) * 1e3);
            let weight = 0.5 * (d0 * gravity(h0) / p0 + d1 * gravity(h1) / p1) / 1e5;
            assert!((fall / weight - 1.0).abs() < 1.5e-2, "{h0} to {h1} km: {}", fall / weight - 1.0);
        }
    }

    /// Density comes back as printed, and the gas constant is that of the mixture, 191.4 J/(kg K) for 43.44 g/mol, to its
    /// compressibility of 1 %.
    #[test]
    fn pub_density_is_the_printed_one() {
        for ([km, _, _, density], (h, air)) in rows().zip(table().rows()) {
            assert!((h - km * 1e3).abs() < 1e-9 && (air.density_kg_m3() / density - 1.0).abs() < 1e-14);
            assert!((air.gas_constant_j_kg_k / 191.4 - 1.0).abs() < 0.012, "{km} km: {}", air.gas_constant_j_kg_k);
        }
    }
}
