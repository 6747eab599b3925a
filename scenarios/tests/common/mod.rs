//! scenarios tests: a record that several of them write.

use windfall_model::Record;

/// 400 samples at 150 Hz of slow waves.
pub(crate) fn waves() -> Record {
    let t_s: Vec<f64> = (0..400).map(|i| f64::from(i) / 150.0).collect();
    let wave = |a: f64| t_s.iter().map(|t| a * (3.0 * t).sin()).collect::<Vec<f64>>();
    Record {
        position_m: [wave(0.1), wave(0.2), wave(0.1)],
        attitude_rad: [wave(0.9), wave(0.2), wave(0.1)],
        vw_m_s: vec![7.43; t_s.len()],
        ps_pa: vec![101_325.0; t_s.len()],
        ts_k: vec![299.0; t_s.len()],
        t_s,
        ..Record::default()
    }
}
