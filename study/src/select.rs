//! study: quantiles of more numbers than fit in memory. In: numbers shown as often as asked. Out: quantiles, exact.
//!
//! Radix selection on the numbers' bits in their total order: each pass counts the next eleven bits of what agrees with a wanted
//! order statistic so far, so six passes and a few histograms are enough for any count of numbers. Few are read once and sorted.

use windfall_model::study::Cell;

/// Shows every cell of a column, each time it is asked.
pub(super) type Read<'r, E> = &'r dyn Fn(&mut dyn FnMut(Cell)) -> Result<(), E>;

/// Lowest bit of each pass, and the bit above its highest.
const PASSES: [(u32, u32); 6] = [(53, 64), (42, 53), (31, 42), (20, 31), (9, 20), (0, 9)];

/// Numbers that are held at once, 4 kB; the histograms of more take 300 kB.
const SORTED: u64 = 512;

/// A wanted order statistic: its bits above the pass, and its rank among the numbers that share them.
#[derive(Clone, Copy)]
struct Wanted {
    above: u64,
    rank: u64,
}

/// Quantiles (linear between order statistics; Hyndman and Fan 1996, type 7) of `n` numbers, at least one.
///
/// # Errors
/// Those of `read`.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a place among the numbers")]
pub(super) fn quantiles<E>(probabilities: &[f64], n: u64, read: Read<'_, E>) -> Result<Vec<f64>, E> {
    let places: Vec<f64> = probabilities.iter().map(|p| p * (n - 1) as f64).collect();
    let ranks: Vec<u64> = places.iter().flat_map(|at| [at.floor() as u64, (at.floor() as u64 + 1).min(n - 1)]).collect();
    let values = if n <= SORTED { sorted(&ranks, read)? } else { at_ranks(&ranks, read)? };
    Ok(places.iter().zip(values.chunks_exact(2)).map(|(at, v)| v[0] + (at - at.floor()) * (v[1] - v[0])).collect())
}

/// Numbers at these ranks, at most [`SORTED`] of them.
#[expect(clippy::cast_possible_truncation, reason = "a place among the numbers")]
fn sorted<E>(ranks: &[u64], read: Read<'_, E>) -> Result<Vec<f64>, E> {
    let mut all = Vec::new();
    read(&mut |cell| all.extend(cell.number()))?;
    all.sort_unstable_by(f64::total_cmp);
    Ok(ranks.iter().map(|&rank| all[rank as usize]).collect())
}

/// Numbers at these ranks of the sorted numbers, by selection.
fn at_ranks<E>(ranks: &[u64], read: Read<'_, E>) -> Result<Vec<f64>, E> {
    let mut wanted: Vec<Wanted> = ranks.iter().map(|&rank| Wanted { above: 0, rank }).collect();
    for (low, high) in PASSES {
        let mut heads: Vec<u64> = wanted.iter().map(|w| w.above).collect();
        heads.sort_unstable();
        heads.dedup();
        let mut counts = vec![vec![0_u64; 1 << (high - low)]; heads.len()];
        read(&mut |cell| {
            let Some(key) = cell.number().map(key) else { return };
            if let Ok(i) = heads.binary_search(&key.checked_shr(high).unwrap_or(0)) {
                counts[i][below(key >> low, high - low)] += 1;
            }
        })?;
        for w in &mut wanted {
            let Ok(i) = heads.binary_search(&w.above) else { continue };
            let mut digit = 0;
            while digit + 1 < counts[i].len() && w.rank >= counts[i][digit] {
                w.rank -= counts[i][digit];
                digit += 1;
            }
            w.above = (w.above << (high - low)) | digit as u64;
        }
    }
    Ok(wanted.iter().map(|w| number(w.above)).collect())
}

/// The lowest bits.
#[expect(clippy::cast_possible_truncation, reason = "eleven bits at most")]
fn below(key: u64, bits: u32) -> usize {
    (key & ((1 << bits) - 1)) as usize
}

/// Bits that compare as the numbers do (the total order of IEEE 754).
fn key(x: f64) -> u64 {
    let bits = x.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}
fn number(key: u64) -> f64 {
    f64::from_bits(if key >> 63 == 1 { key & !(1 << 63) } else { !key })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(x: &[f64], p: &[f64]) -> Vec<f64> {
        let read = |see: &mut dyn FnMut(Cell)| {
            x.iter().for_each(|v| {
                see(Cell::Number(Some(*v)));
                see(Cell::Number(None));
            });
            Ok::<(), ()>(())
        };
        quantiles(p, x.len() as u64, &read).expect("reads")
    }

    #[test]
    fn exact_quantiles_between_order_statistics() {
        let (x, p) = ([8.0, 1.0, 16.0, 4.0, 2.0], [0.0, 0.25, 0.5, 0.625, 1.0]);
        for (a, b) in of(&x, &p).into_iter().zip([1.0, 2.0, 4.0, 6.0, 16.0]) {
            assert!((a - b).abs() < 1e-15);
        }
    }

    /// As sorting gives them, bit for bit: both signs, both zeros, equal numbers, neighbours that differ in the last bit.
    #[test]
    fn law_selection_is_sorting() {
        let mut x: Vec<f64> = (0..3000_i32).map(|i| f64::from(i * 7919 % 1501 - 700) * 1e-3).collect();
        x.extend([-0.0, 0.0, f64::MIN_POSITIVE, -f64::MAX, f64::MAX, 1.0, f64::from_bits(1.0_f64.to_bits() + 1)]);
        let mut sorted = x.clone();
        sorted.sort_by(f64::total_cmp);
        let last = (x.len() - 1) as f64;
        let p: Vec<f64> = (0..x.len()).step_by(13).map(|i| i as f64 / last).collect();
        for (i, q) in (0..x.len()).step_by(13).zip(of(&x, &p)) {
            // i/last × last may round below i; then the step to i is all but a rounding.
            let neighbours = [i.saturating_sub(1), i, (i + 1).min(x.len() - 1)].map(|k| sorted[k]);
            assert!((q - sorted[i]).abs() <= 1e-12 * (neighbours[2] - neighbours[0]).abs(), "{i}: {q}");
        }
        let ranks: Vec<u64> = (0..x.len() as u64).collect();
        let read = |see: &mut dyn FnMut(Cell)| {
            x.iter().for_each(|v| see(Cell::Number(Some(*v))));
            Ok::<(), ()>(())
        };
        let found = at_ranks(&ranks, &read).expect("reads");
        let held = super::sorted(&ranks, &read).expect("reads");
        let same = |all: &[f64]| all.iter().zip(&sorted).all(|(a, b)| a.to_bits() == b.to_bits());
        assert!(same(&found) && same(&held));
    }
}
