//! Thresholds for identifying an effect. A job has no keys for them; a program that tests another value sets it in a frame.

/// Name of a threshold, and the function that returns a mutable reference to its value in the thresholds `R`.
pub type Rule<R> = (&'static str, fn(&mut R) -> &mut f64);

/// Thresholds for strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainRules {
    /// Log evidence, beyond its prior cost, that an effect needs to be identified: ln(1 / 0.01).
    ///
    /// If nothing is wrong, the mean of a likelihood ratio is one. The sum of all ratios over effects and places, with prior weights that sum to one,
    /// has the mean one as well. By Markov's inequality the sum, and each of its terms, exceeds 100 in at most one case of a hundred, however many
    /// places are searched.
    pub decisive: f64,
    /// Alternative explanations within this log evidence are indistinguishable: odds below twenty to one.
    pub indistinguishable: f64,
    /// Factor for the uncertainty of a stated noise. The stated noise is from some twenty repeats or a data sheet, so its uncertainty is 15 % (1 /
    /// sqrt(2 * 20)).
    pub noise_known: f64,
    /// Largest deviate of a chi-square over all readings. One case in a thousand exceeds it by chance.
    pub deviate: f64,
    /// Largest deviate of a single gauge or run. Of fifty of them, one exceeds 3.5 by chance in one case of a hundred. Noise 15 % above the stated
    /// noise raises this value to 4.
    pub part: f64,
    /// Largest ratio of noise to stated noise. Up to twice, the noise was stated too small; a larger ratio has another cause.
    pub noise: f64,
    /// Share of the resampled run sets that must contain an effect, and the whole set. Below 60 of 100, the lead of a set depends on which runs were
    /// driven. The limit is half of the run sets plus twice the uncertainty of the share, which is five in a hundred.
    pub drawings: f64,
    /// Largest root mean square of a side load, in usual sizes of its kind. As shares of the wheel force, these limits are FX .25, FY .6, MX .3, MY
    /// .1 and MZ .1 (moments per metre). FY is then near the friction of a tyre. The other limits are brake and aligning moments that a stationary
    /// vehicle can bear.
    pub side_load: f64,
    /// Largest distance between neighbouring gauges, in usual distances from a gauge to its nearest gauge. Wrong gains and angles of several
    /// neighbours at once indicate a stiffness change between them rather than as many bad gauges.
    pub near: f64,
}

/// Log evidence that an effect of strain needs to be identified: see [`StrainRules::decisive`].
pub(super) const DECISIVE: f64 = 4.605_170_185_988_091;
/// Largest rate of identified effects on a truck without faults: one in a hundred.
const FALSE_NAMES: f64 = 0.01;
const _: () = assert!(FALSE_NAMES * 100.0 == 1.0);

impl Default for StrainRules {
    fn default() -> Self {
        Self {
            decisive: DECISIVE,
            indistinguishable: 3.0,
            noise_known: 1.15,
            deviate: 3.1,
            part: 4.0,
            noise: 2.0,
            drawings: 0.6,
            side_load: 2.5,
            near: 2.5,
        }
    }
}

impl StrainRules {
    /// Name and value of every threshold.
    pub const ALL: [Rule<Self>; 9] = [
        ("decisive", |r| &mut r.decisive),
        ("indistinguishable", |r| &mut r.indistinguishable),
        ("noise_known", |r| &mut r.noise_known),
        ("deviate", |r| &mut r.deviate),
        ("part", |r| &mut r.part),
        ("noise", |r| &mut r.noise),
        ("drawings", |r| &mut r.drawings),
        ("side_load", |r| &mut r.side_load),
        ("near", |r| &mut r.near),
    ];
}

/// Thresholds for motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionRules {
    /// Log evidence that an effect needs to be identified: odds of 400. Then a set of up to three effects contains a chance effect in fewer than one
    /// job of a hundred.
    pub decisive: f64,
    /// Log evidence of a hint of an effect: odds of three.
    pub hint: f64,
    /// Alternative explanations within this log evidence (odds of 20) are indistinguishable.
    pub indistinguishable: f64,
    /// Factor by which declared noise may be wrong: it comes from a data sheet, or from an estimate at standstill.
    pub noise_factor: f64,
    /// Factor on squared tolerances in a limit, for undeclared effects (a weak coupling to the other side or axle, a rate that varies). They are
    /// assumed to be as large as the declared tolerances, so the squared tolerances count twice.
    pub undeclared: f64,
    /// Rate at which a job with healthy channels may have a channel above its limit, and a complete model a gap above its limit.
    pub false_rate: f64,
    /// Share of the power of an effect that its form may leave as residual. Stretch is integrated from noisy accelerations, and nonlinear terms are
    /// computed from it. They are accurate to about a fifth of their amplitude at the worst (the lower band edge). A second function of the stretch
    /// of one spring must remove this share in addition to the first. Both are one force law.
    pub form: f64,
    /// Share of the power removed by the other vehicle effects that a further effect must remove in addition. Forms are computed from noisy stretch
    /// to about a twentieth of their amplitude within the band. The residual of one form resembles another form.
    pub next_form: f64,
    /// Standard deviation of the logarithm of faulty gains: some per cent are usual, and larger errors are less and less likely.
    pub gain: f64,
    /// Standard deviation of faulty delays, s: some samples at the rates of vehicle records.
    pub delay_s: f64,
    /// Standard deviation of the zero of a load cell, as a share of the weight on it. 1 % remains after a balance on the vehicle.
    pub zero_force: f64,
    /// Standard deviation of the zero of an accelerometer, in g: data sheets of capacitive sensors state 50 mg.
    pub zero_g: f64,
    /// Stiffness within a gap over the stiffness beyond it that separates free play from an end stop. Both have the same force law with two slopes.
    pub play: f64,
    /// Ratio of the gap on the held-out data to its largest value for a complete model. Above this ratio, only the verdict `unknown` is possible.
    /// Three tolerances that are stated too small by half add up to as much.
    pub limits: f64,
    /// Residual, as a share of the measured quantity, above which a fit is invalid. Its parameters then describe no vehicle and are no start for
    /// other fits.
    pub lost: f64,
}

impl Default for MotionRules {
    fn default() -> Self {
        Self {
            decisive: 6.0,
            hint: 1.0,
            indistinguishable: 3.0,
            noise_factor: 1.5,
            undeclared: 2.0,
            false_rate: 0.01,
            form: 0.04,
            next_form: 0.0025,
            gain: 0.1,
            delay_s: 0.01,
            zero_force: 0.01,
            zero_g: 0.05,
            play: 0.2,
            limits: 3.0,
            lost: 0.3,
        }
    }
}

impl MotionRules {
    /// Name and value of every threshold.
    pub const ALL: [Rule<Self>; 15] = [
        ("decisive", |r| &mut r.decisive),
        ("hint", |r| &mut r.hint),
        ("indistinguishable", |r| &mut r.indistinguishable),
        ("noise_factor", |r| &mut r.noise_factor),
        ("undeclared", |r| &mut r.undeclared),
        ("false_rate", |r| &mut r.false_rate),
        ("form", |r| &mut r.form),
        ("next_form", |r| &mut r.next_form),
        ("gain", |r| &mut r.gain),
        ("delay_s", |r| &mut r.delay_s),
        ("zero_force", |r| &mut r.zero_force),
        ("zero_g", |r| &mut r.zero_g),
        ("play", |r| &mut r.play),
        ("limits", |r| &mut r.limits),
        ("lost", |r| &mut r.lost),
    ];
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Asserts that each threshold has a distinct place and that the list has as many entries as the struct has numbers.
    fn all_are_listed<R: Copy + Default>(list: &[Rule<R>]) {
        assert_eq!(list.len() * size_of::<f64>(), size_of::<R>());
        let mut rules = R::default();
        for (k, (_, place)) in (0u32..).zip(list) {
            *place(&mut rules) = f64::from(k);
        }
        for (k, (name, place)) in (0u32..).zip(list) {
            assert_eq!(*place(&mut rules), f64::from(k), "{name}");
        }
    }

    #[test]
    fn every_threshold_is_listed_once() {
        all_are_listed(&StrainRules::ALL);
        all_are_listed(&MotionRules::ALL);
    }

    #[test]
    fn the_evidence_of_a_name_is_that_of_one_false_name_in_a_hundred() {
        assert!((StrainRules::default().decisive - 100f64.ln()).abs() < 1e-12);
    }
}
