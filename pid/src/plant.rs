//! pid: the way back from an estimation to what can be flown. In: a data set and the declared plant. Out: the plant with all that was
//! found in it, gusts included.

use crate::error::PidError;
use crate::identification::{DataSet, Estimate, FoundEffect};
use windfall_model::{Acts, Campaign, Effect, PLANT_NUMBERS, Plant, Turbulence, effects};

/// Under what the random drive is reported.
pub const TURBULENCE: &str = "turbulence";
/// The same of random moments beside gusts.
pub const PROCESS_NOISE: &str = "process-noise";
/// Scale of gusts where nothing is known of it, three model diameters (m).
pub(crate) const START_SCALE_M: f64 = 0.6;

impl DataSet {
    /// The campaign's model with all that was found put in ([`DataSet::plant`]). A declared effect of which the set says nothing, since it
    /// was found on another campaign, acts with its declared values.
    ///
    /// # Errors
    /// As [`DataSet::plant`].
    pub fn plant_in(&self, campaign: &Campaign) -> Result<Plant, PidError> {
        let mut plant = self.plant(&campaign.plant)?;
        for (effect, values) in self.declared_beside(campaign) {
            (effect.apply)(&mut plant, values);
        }
        Ok(plant)
    }
    /// Declared effects of a campaign of which the set says nothing.
    pub fn declared_beside<'c>(&self, campaign: &'c Campaign) -> impl Iterator<Item = (&'static Effect, &'c [f64])> {
        let of_gusts = self.parameters.iter().any(|p| Gust::of_name(&p.name).is_some());
        let is_said = move |family: &str| self.effects.iter().any(|e| e.family == family) || (of_gusts && family == TURBULENCE);
        campaign.knowledge.effects.iter().filter(move |(e, _)| !is_said(e.family)).map(|(e, values)| (*e, values.as_slice()))
    }
    /// The declared plant, without declared effects, with what was found put in: parameters ([`DataSet::values`]), constants, size and
    /// scale of the gusts where filter error estimated or held them, and the effects of the model. The only way back from an estimation to
    /// what can be flown. What drives a run beside gusts (`process-noise`, [`DataSet::not_flown`]) has no place in a plant.
    ///
    /// # Errors
    /// [`PidError::OtherStructure`], [`PidError::OtherConstant`] and [`PidError::OtherEffect`] for what the plant has no place for.
    pub fn plant(&self, declared: &Plant) -> Result<Plant, PidError> {
        let structure = &declared.aero.structure;
        let mut plant = declared.clone();
        plant.aero.values = self.values(structure, &plant.aero.values);
        for constant in &self.constants {
            let number = PLANT_NUMBERS.iter().find(|n| n.name() == constant.name);
            let place = number.and_then(|n| (n.lens)(&mut plant));
            *place.ok_or_else(|| PidError::OtherConstant { key: constant.name.clone() })? = constant.estimate;
        }
        plant.turbulence = self.turbulence(plant.turbulence);
        for found in &self.effects {
            found.apply(&mut plant)?;
        }
        let known = |p: &Estimate| match p.coefficient.as_str() {
            TURBULENCE => Gust::of_name(&p.name).is_some(),
            PROCESS_NOISE => true,
            _ => structure.index(&p.name).is_some(),
        };
        match self.parameters.iter().find(|p| !known(p)) {
            None => Ok(plant),
            Some(p) => Err(PidError::OtherStructure { name: p.name.clone(), allowed: structure.parameters.join(", ") }),
        }
    }
    /// Gusts as estimated or held; as declared where the set says nothing of them. A gust without a scale anywhere has that at which the
    /// search starts.
    fn turbulence(&self, declared: Turbulence) -> Turbulence {
        let held = |name: &str| self.held.iter().find(|h| h.name == name).map(|h| h.value);
        let mut found = declared;
        for gust in Gust::ALL {
            if let Some(v) = self.get(TURBULENCE, gust.name()).map(|p| p.estimate).or_else(|| held(gust.name())) {
                *gust.of(&mut found) = v;
            }
        }
        for (rms_m_s, scale_m) in
            [(found.axial_rms_m_s, &mut found.axial_scale_m), (found.lateral_rms_m_s, &mut found.lateral_scale_m)]
        {
            if rms_m_s > 0.0 && *scale_m <= 0.0 {
                *scale_m = START_SCALE_M;
            }
        }
        found
    }
    /// Gusts that were found, by name and value; empty where there are none.
    #[must_use]
    pub fn gusts(&self) -> Vec<(&'static str, f64)> {
        let mut found = self.turbulence(Turbulence::default());
        let sizes = [found.axial_rms_m_s, found.lateral_rms_m_s];
        let there = |g: &Gust| match g {
            Gust::AxialRms | Gust::AxialScale => sizes[0] > 0.0,
            Gust::LateralRms | Gust::LateralScale => sizes[1] > 0.0,
        };
        Gust::ALL.into_iter().filter(there).map(|g| (g.name(), *g.of(&mut found))).collect()
    }
    /// Names of what was found to drive the runs and has no place in a plant: random moments beside the gusts.
    #[must_use]
    pub fn not_flown(&self) -> Vec<&str> {
        let driven = |p: &&Estimate| p.coefficient == PROCESS_NOISE && p.estimate > 0.0;
        self.parameters.iter().filter(driven).map(|p| p.name.as_str()).collect()
    }
}

impl FoundEffect {
    /// Puts it into a plant.
    fn apply(&self, plant: &mut Plant) -> Result<(), PidError> {
        let values: Vec<f64> = self.parameters.iter().map(|p| p.estimate).collect();
        let wrong = || PidError::OtherEffect { family: self.family.clone(), numbers: values.len() };
        let effect = effects::find(&self.family, Acts::Lander).ok_or_else(wrong)?;
        // An effect that follows run inputs has numbers of theirs behind its own.
        if values.len() < (effect.parameters)(&[]).len() {
            return Err(wrong());
        }
        (effect.apply)(plant, &values);
        Ok(())
    }
}

/// One number of the gusts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Gust {
    AxialRms,
    LateralRms,
    AxialScale,
    LateralScale,
}

impl Gust {
    pub(crate) const ALL: [Self; 4] = [Self::AxialRms, Self::LateralRms, Self::AxialScale, Self::LateralScale];
    /// Name in results, as in the catalogue's effect.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::AxialRms => "axial_rms_m_s",
            Self::LateralRms => "lateral_rms_m_s",
            Self::AxialScale => "axial_scale_m",
            Self::LateralScale => "lateral_scale_m",
        }
    }
    fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|g| g.name() == name)
    }
    const fn of(self, t: &mut Turbulence) -> &mut f64 {
        match self {
            Self::AxialRms => &mut t.axial_rms_m_s,
            Self::LateralRms => &mut t.lateral_rms_m_s,
            Self::AxialScale => &mut t.axial_scale_m,
            Self::LateralScale => &mut t.lateral_scale_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identification::Held;

    fn set(parameters: &[(&str, &str, f64)], held: &[(&str, f64)]) -> DataSet {
        let estimate = |&(coefficient, name, estimate): &(&str, &str, f64)| Estimate {
            coefficient: coefficient.to_owned(),
            name: name.to_owned(),
            estimate,
            std_error: 0.01,
            rse_percent: None,
            ci95: [0.0; 2],
            std_error_white: 0.01,
        };
        DataSet {
            name: "combined".to_owned(),
            runs: Vec::new(),
            parameters: parameters.iter().map(estimate).collect(),
            fits: Vec::new(),
            condition_number: 1.0,
            n_samples: 0,
            covariance: Vec::new(),
            curves: Vec::new(),
            held: held.iter().map(|(name, value)| Held { name: (*name).to_owned(), value: *value }).collect(),
            constants: Vec::new(),
            effects: Vec::new(),
            refused: Vec::new(),
            envelope: None,
        }
    }

    /// Estimated sizes and scales, a held scale, one that no file names, and gusts that are not there.
    #[test]
    fn exact_gusts_go_back_as_they_were_found() {
        let rms = (TURBULENCE, "lateral_rms_m_s", 0.2);
        let estimated = set(&[rms, (TURBULENCE, "axial_rms_m_s", 0.0), (TURBULENCE, "lateral_scale_m", 0.9)], &[]);
        let found = Turbulence { lateral_rms_m_s: 0.2, lateral_scale_m: 0.9, ..Turbulence::default() };
        assert_eq!(estimated.turbulence(Turbulence::default()), found);
        assert_eq!(estimated.gusts(), [("lateral_rms_m_s", 0.2), ("lateral_scale_m", 0.9)]);
        let held = set(&[rms], &[("lateral_scale_m", 0.5), ("Cl_0", 0.0125)]);
        assert_eq!(held.turbulence(Turbulence::default()), Turbulence { lateral_scale_m: 0.5, ..found });
        let unnamed = set(&[rms], &[]);
        assert_eq!(unnamed.turbulence(Turbulence::default()), Turbulence { lateral_scale_m: START_SCALE_M, ..found });
        // Regression says nothing of gusts: they stay as declared.
        assert_eq!(set(&[("CA", "CA_T0", 6.6)], &[]).turbulence(found), found);
        let driven = set(&[(PROCESS_NOISE, "roll_rad_s1_5", 0.1), (PROCESS_NOISE, "across_rad_s1_5", 0.0)], &[]);
        assert_eq!((driven.not_flown(), driven.gusts()), (vec!["roll_rad_s1_5"], Vec::new()));
    }
}
