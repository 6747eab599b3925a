//! model: Froude scaling between full scale and model (thesis §2.1.2, Table 2.2). In: length and density ratios. Out: scaled plant.

/// Ratios full scale over model that keep Froude number V²/(g L), mass ratio m/(ρ L³) and inertia ratio I/(ρ L⁵).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FroudeScale {
    /// Length ratio (4 for a 25 % model).
    pub length: f64,
    /// Density ratio.
    pub density: f64,
    /// Gravity ratio.
    pub gravity: f64,
}

impl FroudeScale {
    /// Mass ratio ρ L³.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.density * self.length.powi(3)
    }
    /// Inertia ratio ρ L⁵.
    #[must_use]
    pub fn inertia(&self) -> f64 {
        self.density * self.length.powi(5)
    }
    /// Time ratio √(L/g).
    #[must_use]
    pub fn time(&self) -> f64 {
        (self.length / self.gravity).sqrt()
    }
    /// Speed ratio √(L g).
    #[must_use]
    pub fn speed(&self) -> f64 {
        (self.length * self.gravity).sqrt()
    }
    /// Force ratio ρ L³ g.
    #[must_use]
    pub fn force(&self) -> f64 {
        self.mass() * self.gravity
    }
    /// Area ratio L².
    #[must_use]
    pub fn area(&self) -> f64 {
        self.length * self.length
    }
}
