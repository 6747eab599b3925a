//! scenarios: run files as records. In: a path, the instruments' noise, a window. Out: records in SI and rad, with what was repaired.

use crate::clean::{SIGMAS, Spike, bridge, pieces, remove_spikes, unwrap_deg};
use crate::columns::{Columns, fault, some_of, write_columns_csv};
use crate::error::{Fault, ReadError, WriteError};
use crate::formats::read_columns;
use crate::grid::{Grid, LONGEST_BRIDGE_S};
use crate::own::{Own, QUATERNION};
use crate::run_columns::{Who, is_of_tunnel, names_of};
use crate::units;
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;
use windfall_model::{CHANNEL_NAMES, POSE, Record, Recording, RunChannel, Sensors};

/// Shortest piece of a split run that is kept, s.
pub const SHORTEST_PIECE_S: f64 = 1.0;
/// Fewest samples of a run or piece.
pub const FEWEST_SAMPLES: usize = 30;
/// Longest sample interval of a run with attitude in a tunnel, s: a model swings once in a second or so (chosen).
const LONGEST_STEP_S: f64 = 1.0;
/// More spikes than this fraction of the samples are no spikes.
const MOST_SPIKES: f64 = 0.05;
/// Specific forces along the file's axes.
const FORCES: [&str; 3] = ["fX_m_s2", "fY_m_s2", "fZ_m_s2"];
/// Dynamic pressure, which may be absent.
const QW: &str = "qW_Pa";
/// Deviation of a slow channel (pressure, temperature) below which nothing is a spike, as a fraction of its value.
const SLOW_FLOOR: f64 = 2e-4;

/// A run or a piece of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The samples.
    pub record: Record,
    /// What was bridged, removed or cut, in words.
    pub notes: Vec<String>,
}

/// The instruments of thesis Table A.3: 0.75 mm, 0.0623° roll, 0.110° pitch and yaw, 2.57 mm/s.
#[must_use]
pub fn sensors_of_table_a3() -> Sensors {
    Sensors {
        position_std_m: 7.5e-4,
        roll_std_rad: 0.0623_f64.to_radians(),
        pitch_yaw_std_rad: 0.110_f64.to_radians(),
        wind_std_m_s: 2.57e-3,
        ..Sensors::default()
    }
}

/// Reads a tunnel run of one piece with the instruments of thesis Table A.3.
///
/// # Errors
/// [`ReadError`] with every fault; also when a gap longer than 0.1 s splits the run, see [`read_record_pieces`].
pub fn read_record_csv(path: &Path) -> Result<Record, ReadError> {
    let mut all = read_record_pieces(path, &sensors_of_table_a3(), None)?;
    if all.len() == 1 {
        return Ok(all.swap_remove(0).record);
    }
    let what = format!("gaps longer than {LONGEST_BRIDGE_S} s split this run into {} pieces", all.len());
    Err(ReadError::Faults(vec![fault(path, None, "t_s", "", &what, "read it in a campaign, or with window_s")]))
}

/// Reads a tunnel run: dropouts up to 0.1 s bridged, longer ones split the run, spikes beyond six robust standard deviations of
/// the local fit removed. `sensors` are the declared deviations, below which no error is a spike; `window_s` the part of the file
/// that is used, in its own time. Notes say what was done; the first piece carries those of the whole file.
///
/// # Errors
/// [`ReadError`] with every fault of the file.
pub fn read_record_pieces(path: &Path, sensors: &Sensors, window_s: Option<[f64; 2]>) -> Result<Vec<Piece>, ReadError> {
    read_own_pieces(path, &Own::default(), sensors, window_s)
}

/// The same for a file whose columns are its owner's.
pub(crate) fn read_own_pieces(
    path: &Path,
    own: &Own,
    sensors: &Sensors,
    window_s: Option<[f64; 2]>,
) -> Result<Vec<Piece>, ReadError> {
    pieces_of(path, read_columns(path)?, own, sensors, window_s)
}

/// The same for columns that were read, or never were in a file; `path` is what faults name.
pub(crate) fn pieces_of(
    path: &Path,
    columns: Columns,
    own: &Own,
    sensors: &Sensors,
    window_s: Option<[f64; 2]>,
) -> Result<Vec<Piece>, ReadError> {
    let Some(window) = window_s else { return of_window(path, columns, own, sensors, None) };
    let whole = columns.clone();
    let mut pieces = of_window(path, columns, own, sensors, Some(window))?;
    // Faults outside the window are none of a user who cut them off: the window then stands for itself.
    let whole = of_window(path, whole, own, sensors, None).unwrap_or_default();
    let whole: Vec<Arc<Record>> = whole.into_iter().map(|p| Arc::new(p.record)).collect();
    for piece in &mut pieces {
        piece.record.recording = whole.iter().find_map(|w| within(&piece.record, w));
    }
    Ok(pieces)
}

/// The samples of a recording that a window of it has; none where it has other samples.
fn within(window: &Record, whole: &Arc<Record>) -> Option<Recording> {
    let half_s = 0.5 * whole.interval_s();
    let start = whole.t_s.partition_point(|t| *t < window.t_s[0] - half_s);
    let rows = start..start + window.len();
    let [own, theirs] = [&window.t_s, whole.t_s.get(rows.clone())?].map(|t| [t[0], t[t.len() - 1]]);
    let same = own.iter().zip(theirs).all(|(a, b)| (a - b).abs() < half_s);
    same.then(|| Recording { whole: whole.clone(), rows })
}

/// The same for the rows of a window, as if the file had no others.
fn of_window(
    path: &Path,
    columns: Columns,
    own: &Own,
    sensors: &Sensors,
    window_s: Option<[f64; 2]>,
) -> Result<Vec<Piece>, ReadError> {
    let mut columns = own.apply(path, columns)?;
    let mut notes = std::mem::take(&mut columns.notes);
    has_columns(path, &columns)?;
    refuse_unusable(path, &columns, is_of_tunnel, "a tunnel campaign", "remove the column, or give it another name")?;
    let t = times(path, &mut columns, window_s, &mut notes)?;
    let grid = Grid::of(path, t, &columns.lines, &mut notes)?;
    if grid.interval_s > LONGEST_STEP_S {
        let what =
            format!("must be at most {LONGEST_STEP_S} s from sample to sample: between two of them a model turns and swings");
        let remedy = "seconds; [columns] t_s = { unit = \"ms\" } where they are milliseconds";
        let value = format!("{:.6} s (step)", grid.interval_s);
        return Err(ReadError::Faults(vec![fault(path, None, "t_s", &value, &what, remedy)]));
    }
    note_unused(&columns, is_of_tunnel, &mut notes);
    let all = names_of(Who::TunnelRun).filter(|n| *n != "t_s").chain(names_of(Who::TunnelRunMay));
    let mut channels: Vec<(&str, Vec<f64>)> = all.filter_map(|n| columns.get(n).map(|c| (n, grid.spread(c)))).collect();
    let faults = units::faults(path, &channels, sensors);
    if !faults.is_empty() {
        return Err(ReadError::Faults(faults));
    }
    channels.iter_mut().filter(|(n, _)| n.starts_with('R')).for_each(|(_, c)| unwrap_deg(c));
    let spikes = despike(path, &grid, &mut channels, sensors, &mut notes)?;
    cut(path, &grid, &mut channels, &spikes, notes)
}

fn has_columns(path: &Path, columns: &Columns) -> Result<(), ReadError> {
    let faults: Vec<Fault> = names_of(Who::TunnelRun)
        .filter(|n| columns.get(n).is_none())
        .map(|n| {
            let what = format!("column is missing; the file has {}", some_of(columns.names()));
            let near: Vec<&str> = columns.names().iter().map(String::as_str).collect();
            let remedy = crate::table::nearest(n, &near).map_or_else(
                || "names and units of the run file are fixed, unless [columns] of a campaign gives others".to_owned(),
                |near| format!("rename {near} to {n} if it is that, or say {n} = \"{near}\" in [columns] of the campaign"),
            );
            fault(path, columns.header, n, "", &what, &remedy)
        })
        .collect();
    if faults.is_empty() { Ok(()) } else { Err(ReadError::Faults(faults)) }
}

/// Notes the columns that nothing reads.
pub(crate) fn note_unused(columns: &Columns, is_read: impl Fn(&str) -> bool, notes: &mut Vec<String>) {
    let known = |n: &str| is_read(n) || QUATERNION.contains(&n);
    let unused: Vec<&str> = columns.names().iter().map(String::as_str).filter(|n| !known(n)).collect();
    if !unused.is_empty() {
        notes.push(format!("columns not used: {}", some_of(&unused)));
    }
}

/// Refuses a measurement that the campaign cannot use: an accelerometer that goes unheard would be taken for one that was heard.
pub(crate) fn refuse_unusable(
    path: &Path,
    columns: &Columns,
    is_read: impl Fn(&str) -> bool,
    what: &str,
    remedy: &str,
) -> Result<(), ReadError> {
    let measures = |n: &&&str| columns.get(n).is_some_and(|c| c.iter().any(|x| x.is_finite()));
    let faults: Vec<Fault> = FORCES
        .iter()
        .filter(|n| !is_read(n))
        .filter(measures)
        .map(|n| fault(path, columns.header, n, "", &format!("is a specific force, which {what} cannot use"), remedy))
        .collect();
    if faults.is_empty() { Ok(()) } else { Err(ReadError::Faults(faults)) }
}

/// Times of the rows that are used; rows without a time are dropped, and rows outside the window.
pub(crate) fn times(
    path: &Path,
    columns: &mut Columns,
    window_s: Option<[f64; 2]>,
    notes: &mut Vec<String>,
) -> Result<Vec<f64>, ReadError> {
    let all = columns.get("t_s").unwrap_or(&[]).to_vec();
    let untimed = all.iter().filter(|t| !t.is_finite()).count();
    if untimed > 0 {
        notes.push(format!("{untimed} rows without a time dropped"));
    }
    let [from, to] = window_s.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
    let keep: Vec<bool> = all.iter().map(|t| t.is_finite() && *t >= from && *t <= to).collect();
    columns.retain(&keep);
    let copies = columns.drop_copies();
    if copies > 0 {
        notes.push(format!("{copies} rows written twice dropped: each is the row before in every column"));
    }
    let t = columns.get("t_s").unwrap_or(&[]).to_vec();
    let mut faults: Vec<Fault> = [("goes backward", true), ("appears twice", false)]
        .into_iter()
        .filter_map(|(words, back)| {
            let wrong = |i: &usize| if back { t[*i] < t[*i - 1] } else { t[*i].total_cmp(&t[*i - 1]).is_eq() };
            let all: Vec<usize> = (1..t.len()).filter(wrong).collect();
            let first = *all.first()?;
            let rows = if all.len() > 1 {
                format!("; so it is in {} rows, of which this is the first", all.len())
            } else {
                String::new()
            };
            let what = format!("time {words}: the row before has {}{rows}", t[first - 1]);
            let remedy = "sort the rows by time and remove duplicates; check that the file is one run";
            Some(fault(path, Some(columns.lines[first]), "t_s", &t[first].to_string(), &what, remedy))
        })
        .collect();
    if t.len() < 2 {
        let what = format!("fewer than 2 of {} samples are left in the window", all.len());
        let range = format!("the file runs from {} to {} s", least(&all), greatest(&all));
        faults.push(fault(path, None, "t_s", "", &what, &range));
    }
    if faults.is_empty() { Ok(t) } else { Err(ReadError::Faults(faults)) }
}

fn least(x: &[f64]) -> f64 {
    x.iter().copied().fold(f64::NAN, f64::min)
}
fn greatest(x: &[f64]) -> f64 {
    x.iter().copied().fold(f64::NAN, f64::max)
}

fn floor_of(name: &str, channel: &[f64], s: &Sensors) -> f64 {
    let table = sensors_of_table_a3();
    let declared = |declared: f64, usual: f64| if declared > 0.0 { declared } else { usual };
    match name {
        "X_m" | "Y_m" | "Z_m" => declared(s.position_std_m, table.position_std_m),
        "Rx_deg" => declared(s.roll_std_rad, table.roll_std_rad).to_degrees(),
        "Ry_deg" | "Rz_deg" => declared(s.pitch_yaw_std_rad, table.pitch_yaw_std_rad).to_degrees(),
        "VW_m_s" => declared(s.wind_std_m_s, table.wind_std_m_s),
        _ => SLOW_FLOOR * units::median(channel).abs(),
    }
}

/// Removes spikes; true where one was in a motion channel.
fn despike(
    path: &Path,
    grid: &Grid,
    channels: &mut [(&str, Vec<f64>)],
    sensors: &Sensors,
    notes: &mut Vec<String>,
) -> Result<Vec<bool>, ReadError> {
    let mut faults = Vec::new();
    let mut replaced = vec![false; grid.t_s.len()];
    for (name, x) in channels {
        let floor = floor_of(name, x, sensors);
        let spikes = remove_spikes(&grid.t_s, x, grid.interval_s, floor);
        if spikes.len() as f64 > MOST_SPIKES * x.len() as f64 {
            let what = format!("{} of {} samples are beyond {SIGMAS} robust deviations of the local fit", spikes.len(), x.len());
            let remedy = "check this column's source: so many are no spikes";
            faults.push(fault(path, None, name, "", &what, remedy));
        }
        notes.extend(spikes.iter().map(|s| spike_note(name, grid.t_s[s.index], s)));
        spikes.iter().filter(|_| CHANNEL_NAMES.contains(name)).for_each(|s| replaced[s.index] = true);
    }
    if faults.is_empty() { Ok(replaced) } else { Err(ReadError::Faults(faults)) }
}

pub(crate) fn spike_note(name: &str, t_s: f64, s: &Spike) -> String {
    let fit = if s.fit.is_finite() { format!("local fit {:.6} put there", s.fit) } else { "left out".to_owned() };
    format!("{name}: spike of {:.6} at t = {t_s:.4} s removed (beyond {SIGMAS} robust deviations), {fit}", s.value)
}

/// Splits at long gaps, bridges short ones.
fn cut(
    path: &Path,
    grid: &Grid,
    channels: &mut Vec<(&str, Vec<f64>)>,
    spikes: &[bool],
    mut notes: Vec<String>,
) -> Result<Vec<Piece>, ReadError> {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive count of samples in 0.1 s")]
    let longest = (LONGEST_BRIDGE_S / grid.interval_s + 1e-6).floor() as usize;
    for name in names_of(Who::TunnelRunMay) {
        if let Some(i) = channels.iter().position(|(n, _)| *n == name)
            && pieces(&[&channels[i].1], longest) != pieces(&[&grid.t_s], longest)
        {
            channels.remove(i);
            let instead = if name == QW { " (q is computed from V, p and T)" } else { "" };
            notes.push(format!("{name}: has gaps longer than {LONGEST_BRIDGE_S} s or open ends; not used{instead}"));
        }
    }
    let views: Vec<&[f64]> = channels.iter().map(|(_, c)| c.as_slice()).collect();
    let ranges = pieces(&views, longest);
    let enough =
        |r: &std::ops::Range<usize>| r.len() >= FEWEST_SAMPLES && (r.len() - 1) as f64 * grid.interval_s >= SHORTEST_PIECE_S;
    let (kept, short): (Vec<_>, Vec<_>) = ranges.into_iter().partition(enough);
    let span = |r: &std::ops::Range<usize>| format!("{:.4} to {:.4} s", grid.t_s[r.start], grid.t_s[r.end - 1]);
    notes.extend(short.iter().map(|r| {
        format!("piece from {} dropped: shorter than {SHORTEST_PIECE_S} s or {FEWEST_SAMPLES} samples between gaps", span(r))
    }));
    if kept.is_empty() {
        let what = format!(
            "no stretch of {SHORTEST_PIECE_S} s and {FEWEST_SAMPLES} samples without a gap longer than {LONGEST_BRIDGE_S} s"
        );
        let found = format!("{} samples at {:.4} s", grid.samples, grid.interval_s);
        let remedy = "a longer run, a wider window_s, or data with fewer dropouts";
        return Err(ReadError::Faults(vec![fault(path, None, "samples", &found, &what, remedy)]));
    }
    let dropped = kept.iter().map(std::ops::Range::len).sum::<usize>();
    if kept.len() == 1 && dropped < grid.samples {
        notes.push(format!("used from {}: {} of {} samples", span(&kept[0]), dropped, grid.samples));
    }
    if kept.len() > 1 {
        let list = kept.iter().map(&span).collect::<Vec<_>>().join(", ");
        notes.push(format!("split by gaps longer than {LONGEST_BRIDGE_S} s into {} pieces: {list}", kept.len()));
    }
    Ok(kept.into_iter().map(|r| piece(grid, channels, spikes, r, &mut notes)).collect())
}

fn piece(
    grid: &Grid,
    channels: &[(&str, Vec<f64>)],
    spikes: &[bool],
    rows: std::ops::Range<usize>,
    notes: &mut Vec<String>,
) -> Piece {
    let t_s = grid.t_s[rows.clone()].to_vec();
    let mut notes = std::mem::take(notes);
    let bridged = bridged(channels, spikes, &rows);
    let mut take = |name: &str| {
        let mut x = channels.iter().find(|(n, _)| *n == name)?.1[rows.clone()].to_vec();
        let count = bridge(&t_s, &mut x);
        if count > 0 {
            notes.push(format!("{name}: {count} samples bridged (dropouts up to {LONGEST_BRIDGE_S} s)"));
        }
        Some(x)
    };
    let mut needed = |name: &str| take(name).unwrap_or_default();
    let position_m = [needed("X_m"), needed("Y_m"), needed("Z_m")];
    let attitude_rad = ["Rx_deg", "Ry_deg", "Rz_deg"].map(|n| needed(n).into_iter().map(f64::to_radians).collect());
    let (vw_m_s, ps_pa, ts_k) = (needed("VW_m_s"), needed("ps_Pa"), needed("Ts_K"));
    let qw_pa = take(QW);
    Piece { record: Record { t_s, position_m, attitude_rad, vw_m_s, ps_pa, ts_k, qw_pa, bridged, ..Record::default() }, notes }
}

/// Which samples of a piece are not as measured in all motion channels; empty when all are.
fn bridged(channels: &[(&str, Vec<f64>)], spikes: &[bool], rows: &std::ops::Range<usize>) -> Vec<bool> {
    let motion = channels.iter().filter(|(n, _)| CHANNEL_NAMES.contains(n));
    let mut all = spikes[rows.clone()].to_vec();
    for (_, x) in motion {
        all.iter_mut().zip(&x[rows.clone()]).for_each(|(b, x)| *b |= !x.is_finite());
    }
    if all.contains(&true) { all } else { Vec::new() }
}

/// A tunnel run in the columns of the run file; angles in degrees, roll as it is (unwrapped).
#[must_use]
pub fn record_columns(record: &Record) -> Vec<(&'static str, Cow<'_, [f64]>)> {
    let mut columns = vec![("t_s", Cow::from(&record.t_s))];
    for (channel, series) in RunChannel::ALL.into_iter().zip(record.channels()).take(POSE) {
        let ours = if channel.is_angle() { series.iter().map(|x| x.to_degrees()).collect() } else { Cow::from(series) };
        columns.push((CHANNEL_NAMES[channel.at()], ours));
    }
    columns.extend(record.qw_pa.as_ref().map(|q| (QW, Cow::from(q))));
    columns.push(("ps_Pa", Cow::from(&record.ps_pa)));
    columns.push((CHANNEL_NAMES[RunChannel::Wind.at()], Cow::from(&record.vw_m_s)));
    columns.push(("Ts_K", Cow::from(&record.ts_k)));
    columns
}

/// Writes a tunnel run as [`record_columns`] has it.
///
/// # Errors
/// [`WriteError`] when series differ in length or the file cannot be written.
pub fn write_record_csv(path: &Path, record: &Record) -> Result<(), WriteError> {
    let columns = record_columns(record);
    write_columns_csv(path, &columns.iter().map(|(name, series)| (*name, &**series)).collect::<Vec<_>>())
}
