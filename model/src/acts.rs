//! model: bodies that an effect can act on.

/// Which bodies an effect can act on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Acts {
    /// A body with attitude, in the tunnel or in free flight.
    Lander,
    /// Runs of a lander whose records are at hand: what drifts in them, or differs between them.
    Runs,
    /// A body without attitude in free flight.
    PointMass,
    /// Such a body whose height is that of a pressure altimeter.
    Altimeter,
    /// A body on a pivot.
    Pivot,
    /// A body without attitude, in free flight or on a pivot.
    PointOrPivot,
    /// A rigid body in free flight through air at rest.
    FreeFlight,
    /// A body with attitude: a lander, or a rigid body in free flight.
    Attitude,
    /// Any: an instrument that all are measured by.
    Any,
}

impl Acts {
    /// Whether an effect that acts so can act on that body.
    #[must_use]
    pub fn on(self, body: Self) -> bool {
        self == Self::Any
            || self == body
            || (self == Self::Runs && body == Self::Lander)
            || (self == Self::PointMass && body == Self::Altimeter)
            || (self == Self::Attitude && matches!(body, Self::Lander | Self::FreeFlight))
            || (self == Self::PointOrPivot && matches!(body, Self::PointMass | Self::Altimeter | Self::Pivot))
    }
}
