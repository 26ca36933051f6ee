//! Mean stress: the fully reversed cycle that does the damage of a cycle with a mean.

/// Correction of a cycle for its mean stress.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum MeanStress {
    /// None: only the range counts.
    #[default]
    None,
    /// Goodman: amplitude / (1 - mean / ultimate) for means in tension, the amplitude for means in compression.
    Goodman {
        /// Ultimate strength, unit of the stress.
        ultimate: f64,
    },
    /// Smith, Watson and Topper: root of largest stress times amplitude; 0 for cycles in compression throughout.
    SmithWatsonTopper,
    /// Sensitivity M to the mean, with the four ranges of the stress ratio R of the FKM guideline.
    Sensitivity {
        /// Sensitivity M, 0 to below 1.
        m: f64,
    },
}

impl MeanStress {
    /// Returns the range of the fully reversed cycle (mean 0) that does the same damage; infinite where the mean reaches the ultimate strength.
    ///
    /// With amplitude a = range / 2 and mean s, the FKM guideline gives these amplitudes for the stress ratio R = (s - a) / (s + a):
    ///
    /// - R > 1 (compression): a (1 - M)
    /// - R <= 0: a + M s
    /// - 0 < R < 0.5: (1 + M) (a + M s / 3) / (1 + M / 3)
    /// - R >= 0.5: 3 a (1 + M)^2 / (3 + M)
    ///
    /// # Reference
    /// J. Goodman, Mechanics Applied to Engineering (1899); K.N. Smith, P. Watson, T.H. Topper, J. of Materials 5 (1970) 767; FKM guideline,
    /// Analytical Strength Assessment (VDMA, 6th edition 2012), section 2.4.2.
    ///
    /// # Example
    /// A cycle from 0 to 200 MPa, with an ultimate strength of 500 MPa:
    /// ```
    /// use strainbridge::series::rainflow::MeanStress;
    ///
    /// let goodman = MeanStress::Goodman { ultimate: 500.0 };
    /// assert!((goodman.reversed_range(200.0, 100.0) - 250.0).abs() < 1e-9);
    /// assert!((MeanStress::SmithWatsonTopper.reversed_range(200.0, 100.0) - 2.0 * (200.0f64 * 100.0).sqrt()).abs() < 1e-9);
    /// assert!((MeanStress::Sensitivity { m: 0.3 }.reversed_range(200.0, 100.0) - 260.0).abs() < 1e-9);
    /// ```
    pub fn reversed_range(self, range: f64, mean: f64) -> f64 {
        let amplitude = 0.5 * range;
        let (least, most) = (mean - amplitude, mean + amplitude);
        let reversed = match self {
            Self::None => amplitude,
            Self::Goodman { ultimate } if mean >= ultimate && amplitude > 0.0 => f64::INFINITY,
            Self::Goodman { ultimate } if mean >= ultimate => 0.0,
            Self::Goodman { ultimate } => amplitude / (1.0 - mean.max(0.0) / ultimate),
            Self::SmithWatsonTopper => (most.max(0.0) * amplitude).sqrt(),
            Self::Sensitivity { m } => {
                if most <= 0.0 {
                    amplitude * (1.0 - m)
                } else if least <= 0.0 {
                    amplitude + m * mean
                } else if least < 0.5 * most {
                    (1.0 + m) * (amplitude + m * mean / 3.0) / (1.0 + m / 3.0)
                } else {
                    3.0 * amplitude * (1.0 + m).powi(2) / (3.0 + m)
                }
            }
        };
        2.0 * reversed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, amplitude 100 and means of -300, -100, 0, 50, 100, 200, 300, 500; M = 0.3, ultimate 1000.
    #[test]
    fn cycles_by_hand() {
        let means = [-300.0, -100.0, 0.0, 50.0, 100.0, 200.0, 300.0, 500.0];
        let goodman = [
            100.0,
            100.0,
            100.0,
            105.263_157_9,
            111.111_111_1,
            125.0,
            142.857_142_9,
            200.0,
        ];
        let swt = [
            0.0,
            0.0,
            100.0,
            122.474_487_1,
            141.421_356_2,
            173.205_080_8,
            200.0,
            244.948_974_3,
        ];
        // 1.3 (100 + 20) / 1.1 at a mean of 200; 3 * 1.69 / 3.3 * 100 from a mean of 300 on.
        let fkm = [
            70.0,
            70.0,
            100.0,
            115.0,
            130.0,
            141.818_181_8,
            153.636_363_6,
            153.636_363_6,
        ];
        for (i, mean) in means.into_iter().enumerate() {
            for (rule, expected) in [
                (MeanStress::None, 100.0),
                (MeanStress::Goodman { ultimate: 1000.0 }, goodman[i]),
                (MeanStress::SmithWatsonTopper, swt[i]),
                (MeanStress::Sensitivity { m: 0.3 }, fkm[i]),
            ] {
                let found = rule.reversed_range(200.0, mean);
                assert!(
                    (found - 2.0 * expected).abs() < 1e-6,
                    "{rule:?} {mean}: {found}"
                );
            }
        }
        let beyond = MeanStress::Goodman { ultimate: 400.0 }.reversed_range(10.0, 400.0);
        assert_eq!(beyond, f64::INFINITY);
    }
}
