//! scenarios: the bundled scenario files. In: a name. Out: its text, and that of tables that it names.

/// Names of the bundled scenarios.
pub const NAMES: [&str; 9] = [
    "appendix-c",
    "sage-unperturbed",
    "sage-perturbed",
    "sage-combined",
    "sage-undeclared",
    "sage-thesis",
    "drop-test",
    "full-scale-venus-20km",
    "pole-push",
];

/// Text of the bundled scenario of that name.
///
/// ```
/// assert!(windfall_scenarios::bundled("appendix-c").is_some());
/// ```
#[must_use]
pub fn bundled(name: &str) -> Option<&'static str> {
    let texts = [
        include_str!("../bundled/appendix-c.toml"),
        include_str!("../bundled/sage-unperturbed.toml"),
        include_str!("../bundled/sage-perturbed.toml"),
        include_str!("../bundled/sage-combined.toml"),
        include_str!("../bundled/sage-undeclared.toml"),
        include_str!("../bundled/sage-thesis.toml"),
        include_str!("../bundled/drop-test.toml"),
        include_str!("../bundled/full-scale-venus-20km.toml"),
        include_str!("../bundled/pole-push.toml"),
    ];
    NAMES.iter().position(|n| *n == name).map(|i| texts[i])
}

/// Names of the bundled planet scenarios.
pub const PLANETS: [&str; 2] = ["venus-descent", "venus-dispersions"];

/// Text of the bundled planet scenario of that name.
pub(crate) fn planet(name: &str) -> Option<&'static str> {
    let texts = [include_str!("../planet/venus-descent.toml"), include_str!("../planet/venus-dispersions.toml")];
    PLANETS.iter().position(|n| *n == name).map(|i| texts[i])
}

/// Names of the bundled scenarios of rigid bodies in free flight.
pub const FREE: [&str; 1] = ["glider-throws"];

/// Text of the bundled one of that name.
pub(crate) fn free(name: &str) -> Option<&'static str> {
    (name == FREE[0]).then_some(include_str!("../bundled/glider-throws.toml"))
}

/// A table or structure that a bundled scenario names.
pub(crate) fn table(file: &str) -> Option<&'static str> {
    match file {
        "venus-wind.csv" => Some(include_str!("../planet/venus-wind.csv")),
        "glider.toml" => Some(include_str!("../bundled/glider.toml")),
        _ => None,
    }
}
