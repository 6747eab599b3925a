//! pid: the table of runs and data sets of a campaign (thesis Table 5.1). In: a campaign. Out: what each run and each data set reached.

use crate::PidError;
use crate::envelope::{Envelope, RunEnvelope, SetEnvelope};
use crate::identification::{ALL_RUNS, DataSet, Identification};
use serde::{Deserialize, Serialize};
use windfall_model::{Campaign, Data, Run, Use};

/// Thesis Table 5.1 of a campaign, run by run besides.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TestTable {
    /// Tunnel runs, in the order of the campaign.
    pub runs: Vec<RunEnvelope>,
    /// Each kind of the runs to identify on, then all of them; empty where there is none.
    pub data_sets: Vec<SetEnvelope>,
}

impl TestTable {
    /// That of an identification; empty of one without envelopes.
    #[must_use]
    pub fn of(found: &Identification) -> Self {
        let row = |d: &DataSet| Some(SetEnvelope { name: d.name.clone(), runs: d.runs.clone(), envelope: d.envelope.clone()? });
        Self { runs: found.envelopes.clone(), data_sets: found.data_sets.iter().filter_map(row).collect() }
    }
}

/// What a run reached, in its campaign's declared flow; none of a body without attitude.
///
/// # Errors
/// As [`Envelope::of_record`].
pub fn run_envelope(campaign: &Campaign, run: usize) -> Result<Option<Envelope>, PidError> {
    let Data::Tunnel(record) = &campaign.runs[run].data else { return Ok(None) };
    Envelope::of_record(record, &campaign.plant_for(&campaign.declared_plant(), run)).map(Some)
}

/// Every tunnel run that airspeed and angles are defined in; `needed` says of which the others are errors.
fn rows(campaign: &Campaign, needed: impl Fn(&Run) -> bool) -> Result<Vec<RunEnvelope>, PidError> {
    let mut all = Vec::new();
    for (i, run) in campaign.runs.iter().enumerate() {
        match run_envelope(campaign, i) {
            Ok(Some(envelope)) => all.push(RunEnvelope {
                name: run.name.clone(),
                kind: run.kind.clone(),
                used: run.used.name().to_owned(),
                envelope,
            }),
            Err(e) if needed(run) => return Err(e),
            Ok(None) | Err(_) => {}
        }
    }
    Ok(all)
}

/// The table of a campaign. A run in which airspeed or angles are not defined has no row.
#[must_use]
pub fn test_table(campaign: &Campaign) -> TestTable {
    let runs = rows(campaign, |_| false).unwrap_or_default();
    let identified = || runs.iter().filter(|r| r.used == Use::Identify.name());
    let mut kinds: Vec<&str> = Vec::new();
    identified().for_each(|r| {
        if !kinds.contains(&r.kind.as_str()) {
            kinds.push(&r.kind);
        }
    });
    let set = |name: &str, of: Vec<&RunEnvelope>| {
        let envelope = Envelope::joined(of.iter().map(|r| &r.envelope))?;
        Some(SetEnvelope { name: name.to_owned(), runs: of.iter().map(|r| r.name.clone()).collect(), envelope })
    };
    let alone = kinds.iter().map(|k| set(k, identified().filter(|r| r.kind == **k).collect()));
    let data_sets = alone.chain(std::iter::once(set(ALL_RUNS, identified().collect()))).flatten().collect();
    TestTable { runs, data_sets }
}

/// Gives an identification the row of every run, and every data set that of its own.
///
/// # Errors
/// As [`Envelope::of_record`] of a run in a data set; another without airspeed or angles has no row.
pub fn add_envelopes(campaign: &Campaign, found: &mut Identification) -> Result<(), PidError> {
    found.envelopes = rows(campaign, |run| found.data_sets.iter().any(|d| d.runs.contains(&run.name)))?;
    for set in &mut found.data_sets {
        let own = found.envelopes.iter().filter(|r| set.runs.contains(&r.name));
        set.envelope = Envelope::joined(own.map(|r| &r.envelope));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
