//! replay tests: shared data and the plant of the thesis. In: names. Out: campaigns.

use std::io::Write as _;
use std::path::PathBuf;
use windfall_model::{Campaign, Plant, Scenario};
use windfall_scenarios::{read_bundled, read_campaign};

/// Thesis Table 5.5, with the yaw damping equal to that of pitch.
pub(crate) const TABLE_5_5: [f64; 11] =
    [6.6620, 3.5129, -2.0035, 0.0125, -5.6816, -2.0655, 2.5278, -3.3025, -205.4289, -3.3025, -205.4289];

/// Folder of shared data, if there is one; otherwise says that the named test is skipped.
pub(crate) fn shared(test: &str) -> Option<PathBuf> {
    let root = std::env::var_os("WINDFALL_SHARED")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared"), PathBuf::from);
    if root.join("data/campaigns").is_dir() {
        return Some(root);
    }
    // Past the harness, which keeps to itself what a passing test prints.
    let _ = writeln!(std::io::stderr(), "skipped: {test}: no shared data");
    None
}

/// A shared campaign by name.
pub(crate) fn campaign(test: &str, name: &str) -> Option<Campaign> {
    let path = shared(test)?.join("data/campaigns").join(name).join("campaign.toml");
    Some(read_campaign(&path).expect("a shared campaign is well-formed"))
}

/// The campaign's plant with the true parameters of the shared data.
pub(crate) fn with_table_5_5(campaign: &Campaign) -> Plant {
    let mut plant = campaign.plant.clone();
    plant.aero.values = TABLE_5_5.to_vec();
    plant
}

/// A bundled scenario.
pub(crate) fn bundled(name: &str) -> Scenario {
    read_bundled(name).expect("bundled scenarios are well-formed").scenario
}
