//! model: wind over height. In: geometric height. Out: velocity of the air over the ground and its change with height.

use crate::frames::{Ned, Vec3};

/// Where the air goes to.
#[derive(Clone, Debug, PartialEq)]
pub enum Winds {
    /// The same at all heights, m/s; zero for air that turns with the planet.
    Steady {
        /// Toward north, m/s.
        north_m_s: f64,
        /// Toward east, m/s.
        east_m_s: f64,
    },
    /// A table.
    Table(WindTable),
}

impl Winds {
    /// Air at rest over the ground.
    pub const STILL: Self = Self::Steady { north_m_s: 0.0, east_m_s: 0.0 };

    /// Velocity (m/s) and its change with height (1/s) at a height in m. A table is linear between its rows and held beyond its ends.
    #[must_use]
    pub fn at(&self, height_m: f64) -> (Vec3<Ned>, Vec3<Ned>) {
        match self {
            Self::Steady { north_m_s, east_m_s } => (Vec3::new(*north_m_s, *east_m_s, 0.0), Vec3::zero()),
            Self::Table(t) => t.at(height_m),
        }
    }
}

/// Wind over height, two rows or more, heights ascending.
#[derive(Clone, Debug, PartialEq)]
pub struct WindTable {
    rows: Vec<[f64; 3]>,
}

impl WindTable {
    /// A table of height (m), velocity toward north and toward east (m/s); `None` when it has fewer than two rows, a number that is not
    /// finite, or heights that do not ascend.
    #[must_use]
    pub fn new(rows: Vec<[f64; 3]>) -> Option<Self> {
        let finite = rows.iter().flatten().all(|x| x.is_finite());
        (rows.len() >= 2 && finite && rows.windows(2).all(|w| w[0][0] < w[1][0])).then_some(Self { rows })
    }
    /// Height (m), velocity toward north and toward east (m/s).
    #[must_use]
    pub fn rows(&self) -> &[[f64; 3]] {
        &self.rows
    }
    fn at(&self, height_m: f64) -> (Vec3<Ned>, Vec3<Ned>) {
        let last = self.rows.len() - 1;
        let held = |row: [f64; 3]| (Vec3::new(row[1], row[2], 0.0), Vec3::zero());
        if height_m <= self.rows[0][0] {
            return held(self.rows[0]);
        }
        if height_m >= self.rows[last][0] {
            return held(self.rows[last]);
        }
        let i = self.rows.partition_point(|r| r[0] <= height_m);
        let (a, b) = (self.rows[i - 1], self.rows[i]);
        let per_m = 1.0 / (b[0] - a[0]);
        let shear = Vec3::new((b[1] - a[1]) * per_m, (b[2] - a[2]) * per_m, 0.0);
        (Vec3::new(a[1], a[2], 0.0) + shear * (height_m - a[0]), shear)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_linear_between_rows_and_held_beyond() {
        let table = Winds::Table(WindTable::new(vec![[0.0, 1.0, -6.0], [1e3, 3.0, 4.0], [2e3, 3.0, 4.0]]).expect("ascends"));
        for (h, north, east, shear) in
            [(-5.0, 1.0, -6.0, 0.0), (500.0, 2.0, -1.0, 2e-3), (1500.0, 3.0, 4.0, 0.0), (1e5, 3.0, 4.0, 0.0)]
        {
            let (v, s) = table.at(h);
            assert!((v.x() - north).abs() < 1e-12 && (v.y() - east).abs() < 1e-12 && (s.x() - shear).abs() < 1e-15, "{h}");
        }
        assert!(WindTable::new(vec![[0.0; 3], [0.0; 3]]).is_none());
    }
}
