//! model: what a run is for. In: the word of a file. Out: identify, select, hold out.

/// What a run is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// Parameters are identified on it.
    Identify,
    /// Chooses between sets of effects: nothing is fitted to it, nothing reported of it.
    Select,
    /// Only predictions are judged on it.
    HoldOut,
}

impl Use {
    /// All uses.
    pub const ALL: [Self; 3] = [Self::Identify, Self::Select, Self::HoldOut];
    /// Word of the files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Identify => "identify",
            Self::Select => "select",
            Self::HoldOut => "hold-out",
        }
    }
    /// The use of that word.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|u| u.name() == name)
    }
}
