//! pid: the tether's force model from its measurements (thesis §2.1.5, Table 2.3). In: force and speed. Out: drag area and weight.

/// Thesis Table 2.3: pull of the tether, lbf, and tunnel speed, ft/s.
pub const TABLE_2_3_LBF_FT_S: [(f64, f64); 5] = [(0.0040, 22.0), (0.0068, 26.0), (0.0115, 31.0), (0.0148, 33.0), (0.0229, 41.0)];

/// Air density of those measurements, slug/ft³. The dynamic pressures printed beside them are rounded to 0.1 psf and do not
/// reproduce the thesis' Table B.1; ½ρV² with this density does.
pub const DENSITY_SLUG_FT3: f64 = 0.00229;

/// Line `F = q (C_D S)_tr − W_tr` through measurements (eq. B.32), in the units of the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetherFit {
    /// (C_D S)_tr, ft².
    pub drag_area_ft2: f64,
    /// W_tr, lbf.
    pub weight_lbf: f64,
    /// Standard error of (C_D S)_tr, ft².
    pub drag_area_std_ft2: f64,
    /// Standard error of W_tr, lbf.
    pub weight_std_lbf: f64,
}

/// Least-squares line through force (lbf) and speed (ft/s) pairs; at least three, of two speeds or more.
#[must_use]
pub fn fit(measured: &[(f64, f64)], density_slug_ft3: f64) -> Option<TetherFit> {
    let n = measured.len() as f64;
    let q = |v: f64| 0.5 * density_slug_ft3 * v * v;
    let q_mean = measured.iter().map(|m| q(m.1)).sum::<f64>() / n;
    let f_mean = measured.iter().map(|m| m.0).sum::<f64>() / n;
    let sqq: f64 = measured.iter().map(|m| (q(m.1) - q_mean).powi(2)).sum();
    if measured.len() < 3 || sqq.is_nan() || sqq <= 0.0 {
        return None;
    }
    let sqf: f64 = measured.iter().map(|m| (q(m.1) - q_mean) * (m.0 - f_mean)).sum();
    let area = sqf / sqq;
    let weight = area * q_mean - f_mean;
    let s2 = measured.iter().map(|m| (m.0 - area * q(m.1) + weight).powi(2)).sum::<f64>() / (n - 2.0);
    Some(TetherFit {
        drag_area_ft2: area,
        weight_lbf: weight,
        drag_area_std_ft2: (s2 / sqq).sqrt(),
        weight_std_lbf: (s2 * (1.0 / n + q_mean * q_mean / sqq)).sqrt(),
    })
}

/// The fit of Table 2.3.
#[must_use]
pub fn table_2_3() -> TetherFit {
    fit(&TABLE_2_3_LBF_FT_S, DENSITY_SLUG_FT3).expect("five measurements at five speeds")
}

#[cfg(test)]
mod tests;
