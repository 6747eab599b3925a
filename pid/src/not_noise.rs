//! pid: which channels' residual is not noise. In: the fits of a data set. Out: the channels, in the one clause that every method says of them.

use crate::identification::CoefficientFit;
use windfall_model::{CHANNEL_NAMES, CHANNELS, POSE};

/// Probability below which a residual is not taken for noise, all channels together.
pub(crate) const NOT_NOISE: f64 = 0.01;

/// Whether a channel's residual passes for noise at its share of the level.
pub(crate) fn is_noise(whiteness_p: f64) -> bool {
    whiteness_p >= NOT_NOISE / CHANNELS as f64
}

/// Channels of a data set whose residual is not noise. Those of the pose test the declared model. The tunnel speed's tests the record of the
/// tunnel speed alone: that it is a smooth speed with white noise.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NotNoise {
    pose: Vec<String>,
    speed: Option<String>,
}

impl NotNoise {
    /// Of a data set's fits, one for each channel.
    pub(crate) fn of(fits: &[CoefficientFit]) -> Self {
        let bad = fits.iter().filter(|f| !is_noise(f.residual_whiteness_p));
        let words = |f: &CoefficientFit| format!("{} (p = {:.1e})", f.coefficient, f.residual_whiteness_p);
        let (pose, speed): (Vec<_>, Vec<_>) = bad.partition(|f| CHANNEL_NAMES[..POSE].contains(&f.coefficient.as_str()));
        Self { pose: pose.into_iter().map(words).collect(), speed: speed.into_iter().map(words).next() }
    }

    /// Whether the pose, which tests the declared model, leaves noise.
    pub(crate) fn is_noise_of_pose(&self) -> bool {
        self.pose.is_empty()
    }

    /// Whether nothing is to be warned of.
    pub(crate) fn is_none(&self) -> bool {
        self.pose.is_empty() && self.speed.is_none()
    }

    /// Channels of the pose, in words; the tunnel speed's after them.
    pub(crate) fn channels(&self) -> Vec<String> {
        self.pose.iter().chain(&self.speed).cloned().collect()
    }

    /// What the residual is, as the end of a sentence: a method's reason and its warnings say it in these words alone.
    pub(crate) fn clause(&self) -> String {
        match (&self.speed, self.pose.is_empty()) {
            (None, true) => "noise in every channel".to_owned(),
            (Some(speed), true) => format!("noise in every channel of the pose and not in {speed}"),
            _ => format!("not noise in {}", self.channels().join(", ")),
        }
    }

    /// What a residual that is not noise means for the declared model.
    pub(crate) fn meaning(&self) -> &'static str {
        if self.pose.is_empty() {
            "the record of the tunnel speed is no smooth speed with white noise (filtered, delayed or with more noise than declared)"
        } else {
            "the declared model lacks something (turbulence or another effect)"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fits(not_noise: &[&str]) -> Vec<CoefficientFit> {
        let fit = |name: &&str| CoefficientFit {
            coefficient: (*name).to_owned(),
            r2: 1.0,
            residual_std: 1.0,
            residual_whiteness_p: if not_noise.contains(name) { 1e-5 } else { 0.5 },
        };
        CHANNEL_NAMES.iter().map(fit).collect()
    }

    /// The reason for a method and the warning beside it are the same clause, so that neither calls noise what the other does not.
    #[test]
    fn law_the_clause_names_every_channel_that_is_not_noise() {
        assert_eq!(NotNoise::of(&fits(&[])).clause(), "noise in every channel");
        for channels in [&["VW_m_s"][..], &["Rz_deg"], &["X_m", "VW_m_s"]] {
            let found = NotNoise::of(&fits(channels));
            let clause = found.clause();
            assert!(clause.contains("not ") && !clause.contains("every channel and"), "{clause}");
            assert!(channels.iter().all(|c| clause.contains(c)), "{clause}");
            assert_eq!(found.is_noise_of_pose(), channels == ["VW_m_s"]);
            assert!(!found.is_none());
        }
        assert_eq!(
            NotNoise::of(&fits(&["VW_m_s"])).clause(),
            "noise in every channel of the pose and not in VW_m_s (p = 1.0e-5)"
        );
    }
}
