//! model: the vector of unknowns. In: which numbers a search may change, what is known of each. Out: the plant that they make.
//!
//! One type for every search that knows its numbers by name: parameters of the aerodynamic structure, parameters of effects, and errors of instruments that no plant has. Free ones have a column; tied ones share that of another.

use crate::effects::Effect;
use crate::plant::Plant;

/// Which number is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnknownId {
    /// Parameter of the aerodynamic structure, by index.
    Parameter(usize),
    /// Parameter (second) of an effect of this vector (first).
    Effect(usize, usize),
    /// Number that no plant has, by name.
    Nuisance(&'static str),
}

/// From the coordinate in which a number is searched to its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transform {
    /// The value itself.
    Linear,
    /// Share of the way from one value to another, kept in [0, 1].
    Share {
        /// Value at 0.
        low: f64,
        /// Value at 1.
        high: f64,
    },
    /// The same along the logarithm; both above zero.
    LogShare {
        /// Value at 0.
        low: f64,
        /// Value at 1.
        high: f64,
    },
    /// Share of so many decades below a value, which may be negative; kept in [0, 1].
    Decades {
        /// Value at 1.
        end: f64,
        /// Decades from 0 to 1.
        decades: f64,
    },
}

impl Transform {
    /// Value at a coordinate.
    #[must_use]
    pub fn value(self, at: f64) -> f64 {
        let share = at.clamp(0.0, 1.0);
        match self {
            Self::Linear => at,
            Self::Share { low, high } => low + share * (high - low),
            Self::LogShare { low, high } => low * (high / low).powf(share),
            Self::Decades { end, decades } => end * 10.0_f64.powf(-decades * (1.0 - share)),
        }
    }
    /// Coordinate of a value; of decades without regard to its sign.
    #[must_use]
    pub fn at(self, value: f64) -> f64 {
        let share = match self {
            Self::Linear => return value,
            Self::Share { low, high } => (value - low) / (high - low),
            Self::LogShare { low, high } => (value / low).ln() / (high / low).ln(),
            Self::Decades { end, decades } => 1.0 + (value / end).abs().max(1e-300).log10() / decades,
        };
        share.clamp(0.0, 1.0)
    }
}

/// Whether a number is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Freedom {
    /// In this column.
    Free(usize),
    /// In the column of another.
    Tied(usize),
    /// Kept at this value.
    Held(f64),
}

/// One number.
#[derive(Clone, Debug, PartialEq)]
pub struct Unknown {
    /// Which.
    pub id: UnknownId,
    /// Name in results.
    pub name: String,
    /// How it is searched.
    pub transform: Transform,
    /// Its coordinate.
    pub at: f64,
    /// Whether it is searched.
    pub freedom: Freedom,
}

impl Unknown {
    /// A number at a value, searched as it is.
    #[must_use]
    pub fn linear(id: UnknownId, name: &str, value: f64, freedom: Freedom) -> Self {
        Self { id, name: name.to_owned(), transform: Transform::Linear, at: value, freedom }
    }
    /// Its value: in SI, rad of angles.
    #[must_use]
    pub fn value(&self) -> f64 {
        if let Freedom::Held(value) = self.freedom { value } else { self.transform.value(self.at) }
    }
    /// Its column; none where held.
    #[must_use]
    pub const fn column(&self) -> Option<usize> {
        match self.freedom {
            Freedom::Free(c) | Freedom::Tied(c) => Some(c),
            Freedom::Held(_) => None,
        }
    }
}

/// Unknown numbers, the effects whose parameters are among them, and the plant that they make.
///
/// ```
/// use windfall_model::{Freedom, Unknown, UnknownId, Unknowns};
/// let free = |i: usize, name: &str, value: f64| Unknown::linear(UnknownId::Parameter(i), name, value, Freedom::Free(i));
/// let mut unknowns = Unknowns::from(vec![free(0, "CA_T0", 6.6), free(1, "Cl_p", -5.7)]);
/// unknowns.hold(0);
/// let moved = unknowns.moved(&[0.5], 1.0);
/// assert_eq!(moved.values(), [-5.2]);
/// assert_eq!(moved.names(), ["Cl_p"]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unknowns {
    /// The numbers.
    pub all: Vec<Unknown>,
    effects: Vec<&'static Effect>,
    /// Place, mean and standard deviation of what is known of coordinates beforehand, in the order given.
    priors: Vec<(usize, f64, f64)>,
}

impl From<Vec<Unknown>> for Unknowns {
    fn from(all: Vec<Unknown>) -> Self {
        Self { all, ..Self::default() }
    }
}

impl Unknowns {
    /// Effects whose parameters may be among the numbers, in the order in which they act.
    #[must_use]
    pub fn effects(&self) -> &[&'static Effect] {
        &self.effects
    }
    /// One more effect; its place.
    pub fn act(&mut self, effect: &'static Effect) -> usize {
        self.effects.push(effect);
        self.effects.len() - 1
    }
    /// Number of columns.
    #[must_use]
    pub fn free(&self) -> usize {
        self.all.iter().filter(|u| matches!(u.freedom, Freedom::Free(_))).count()
    }
    /// Names by column.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        self.leaders().map(|u| u.name.clone()).collect()
    }
    /// Name of a column, for messages.
    #[must_use]
    pub fn name(&self, column: usize) -> &str {
        self.leaders().nth(column).map_or("", |u| &u.name)
    }
    /// Coordinates by column.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        self.leaders().map(|u| u.at).collect()
    }
    /// Free numbers in the order of their columns.
    fn leaders(&self) -> impl Iterator<Item = &Unknown> {
        let mut all: Vec<(usize, &Unknown)> =
            self.all.iter().filter_map(|u| if let Freedom::Free(c) = u.freedom { Some((c, u)) } else { None }).collect();
        all.sort_by_key(|(c, _)| *c);
        all.into_iter().map(|(_, u)| u)
    }
    /// Where a number stands.
    #[must_use]
    pub fn position(&self, id: UnknownId) -> Option<usize> {
        self.all.iter().position(|u| u.id == id)
    }
    /// Values of the structure's parameters, in its order.
    #[must_use]
    pub fn parameters(&self) -> Vec<f64> {
        self.of_parameters().map(Unknown::value).collect()
    }
    /// The structure's parameters, in its order.
    pub fn of_parameters(&self) -> impl Iterator<Item = &Unknown> {
        self.all.iter().filter(|u| matches!(u.id, UnknownId::Parameter(_)))
    }
    /// One more prior, independent of those before: mean and standard deviation of the coordinate of number `at`.
    pub fn know(&mut self, at: usize, mean: f64, std: f64) {
        self.priors.push((at, mean, std));
    }
    /// Holds a column at its value, which ends its priors; later columns move up.
    pub fn hold(&mut self, column: usize) {
        for u in &mut self.all {
            let next = |c: usize| if c > column { c - 1 } else { c };
            match u.freedom {
                Freedom::Free(c) | Freedom::Tied(c) if c == column => {
                    u.freedom = Freedom::Held(u.value());
                }
                Freedom::Free(c) => u.freedom = Freedom::Free(next(c)),
                Freedom::Tied(c) => u.freedom = Freedom::Tied(next(c)),
                Freedom::Held(_) => {}
            }
        }
    }
    /// Holds one number at a value; where others are tied to it, they are held where they are.
    pub fn hold_at(&mut self, at: usize, value: f64) {
        if let Some(column) = self.all[at].column() {
            self.hold(column);
        }
        self.all[at].freedom = Freedom::Held(value);
    }
    /// Moved by a fraction of a step of the coordinates, by column.
    #[must_use]
    pub fn moved(&self, step: &[f64], fraction: f64) -> Self {
        let mut moved = self.clone();
        for u in &mut moved.all {
            if let Some(c) = u.column() {
                u.at += fraction * step[c];
            }
        }
        moved
    }
    /// Free parameters of the structure start from these values, in its order; tied ones from that of the first of them.
    pub fn start(&mut self, values: &[f64]) {
        for column in 0..self.free() {
            let first = self.of_parameters().zip(values).find(|(u, _)| u.column() == Some(column)).map(|(_, v)| *v);
            if let Some(value) = first.filter(|v| v.is_finite()) {
                self.all.iter_mut().filter(|u| u.column() == Some(column)).for_each(|u| u.at = u.transform.at(value));
            }
        }
    }
    /// Column of each prior, distance of its mean from here, and standard deviation, in the order given.
    pub fn priors(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        self.priors.iter().filter_map(|&(at, mean, std)| self.all[at].column().map(|c| (c, mean - self.all[at].at, std)))
    }
    /// Twice the priors' part of the negative log-likelihood.
    #[must_use]
    pub fn prior_misfit(&self) -> f64 {
        self.priors().map(|(_, off, std)| (off / std).powi(2)).sum()
    }
    /// The plant that these numbers make of one: the only way back. Parameters of effects that are not among the numbers are null;
    /// numbers that no plant has stay out.
    #[must_use]
    pub fn plant(&self, base: &Plant) -> Plant {
        let mut plant = base.clone();
        for u in &self.all {
            if let UnknownId::Parameter(i) = u.id {
                plant.aero.values[i] = u.value();
            }
        }
        for (k, effect) in self.effects.iter().enumerate() {
            let null = (effect.parameters)(&[]).into_iter().map(|p| p.null).enumerate();
            let value = |(i, null)| self.position(UnknownId::Effect(k, i)).map_or(null, |at| self.all[at].value());
            (effect.apply)(&mut plant, &null.map(value).collect::<Vec<f64>>());
        }
        plant
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round trips to rounding, ends of the range, and a strength of either sign.
    #[test]
    fn law_coordinates_and_values() {
        let share = Transform::Share { low: -2.0, high: 6.0 };
        let log = Transform::LogShare { low: 0.1, high: 10.0 };
        let down = Transform::Decades { end: -3.0, decades: 4.0 };
        for at in [0.0, 0.3, 1.0] {
            for t in [share, log, down, Transform::Linear] {
                assert!((t.at(t.value(at)) - at).abs() < 1e-14, "{t:?} {at}");
            }
        }
        assert_eq!((share.value(2.0), share.value(0.5), log.value(-1.0)), (6.0, 2.0, 0.1));
        assert!((down.value(1.0), down.at(3.0), down.at(0.0)) == (-3.0, 1.0, 0.0) && (down.value(0.0) + 3e-4).abs() < 1e-18);
    }

    /// Tied numbers move together; holding a column keeps values, drops its priors and moves later columns up; priors keep
    /// their order.
    #[test]
    fn exact_columns() {
        let number = |i, freedom| Unknown::linear(UnknownId::Parameter(i), ["a", "b", "c", "d"][i], i as f64, freedom);
        let all = [Freedom::Tied(1), Freedom::Free(0), Freedom::Held(7.0), Freedom::Free(1)];
        let mut u = Unknowns::from(all.into_iter().enumerate().map(|(i, f)| number(i, f)).collect::<Vec<_>>());
        assert_eq!((u.act(crate::CATALOGUE[0]), u.act(crate::CATALOGUE[1])), (0, 1));
        u.know(3, 4.0, 0.5);
        u.know(1, 3.0, 2.0);
        u.know(3, 3.0, 1.0);
        assert_eq!((u.free(), u.names(), u.values()), (2, vec!["b".to_owned(), "d".to_owned()], vec![1.0, 3.0]));
        assert_eq!(u.priors().collect::<Vec<_>>(), [(1, 1.0, 0.5), (0, 2.0, 2.0), (1, 0.0, 1.0)]);
        assert!((u.prior_misfit() - 5.0).abs() < 1e-15);
        u.start(&[10.0, f64::NAN, 30.0, 40.0]);
        assert_eq!(u.parameters(), [10.0, 1.0, 7.0, 10.0]);
        u.hold(0);
        let moved = u.moved(&[2.0], 0.5);
        assert_eq!((moved.parameters(), moved.names()), (vec![11.0, 1.0, 7.0, 11.0], vec!["d".to_owned()]));
        assert_eq!(moved.priors().collect::<Vec<_>>(), [(0, -7.0, 0.5), (0, -8.0, 1.0)]);
    }
}
