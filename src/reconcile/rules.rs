//! The thresholds that a name depends on. A job has no keys for them: programs that ask what another value would do put it into a frame.

/// A threshold: name, and where it stands.
pub type Rule<R> = (&'static str, fn(&mut R) -> &mut f64);

/// Thresholds of strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainRules {
    /// Log evidence beyond its prior cost that an effect must raise to be named: ln(1 / 0.01).
    ///
    /// Where nothing is wrong, the mean of a likelihood ratio is one, and so is that of the sum of all of them over effects and places with
    /// prior weights that sum to one. By Markov's inequality the sum, and each of its terms, passes 100 in one case of a hundred at most,
    /// however many places are searched.
    pub decisive: f64,
    /// Rivals within this log evidence can't be told apart: odds below twenty to one.
    pub indistinguishable: f64,
    /// A stated noise comes from some twenty repeats, or from a data sheet: it is known to 15 % (1 / sqrt(2 * 20)).
    pub noise_known: f64,
    /// Deviate of a chi-square over all that one case in a thousand has by chance.
    pub deviate: f64,
    /// Deviate of a single gauge or run. Of fifty of them one passes 3.5 by chance in one case of a hundred; noise that is 15 % above what
    /// is stated brings that to 4.
    pub part: f64,
    /// Noise up to twice the stated one is noise that was stated too small; more is something else.
    pub noise: f64,
    /// Share of the resampled run sets that must hold a name, and the whole set: below 60 of 100 it is ahead by the runs that happened to be
    /// driven (half of them, and twice the five in a hundred that the share is known to).
    pub drawings: f64,
    /// Largest root mean square of a side load, in usual sizes of its kind: as shares of the wheel force FX .25, FY .6, MX .3, MY .1 and MZ .1
    /// (moments per metre). FY is then near the friction of a tyre; the others are brakes and aligning moments that a standing vehicle can
    /// hold.
    pub side_load: f64,
    /// Gauges within this many usual distances from gauge to nearest gauge are neighbours: gains and angles of several of them at once are a
    /// change of stiffness between them sooner than as many bad gauges.
    pub near: f64,
}

/// Log evidence that names an effect of strain: see [`StrainRules::decisive`].
pub(super) const DECISIVE: f64 = 4.605_170_185_988_091;
/// A name on a truck that has nothing: one in a hundred at most.
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
    /// Every one of them.
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

/// Thresholds of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionRules {
    /// Log evidence that an effect must bring to be named: odds of 400, so that a set of up to three effects holds a chance one in fewer than
    /// one job of a hundred.
    pub decisive: f64,
    /// Log evidence that is a hint: odds of three.
    pub hint: f64,
    /// Rivals within this log evidence (odds of 20) can't be told apart.
    pub indistinguishable: f64,
    /// Declared noise may be wrong by this factor: it is a data sheet's, or was estimated at rest.
    pub noise_factor: f64,
    /// What no job declares (a weak coupling to the other side or axle, a rate that wanders) is taken to be as large as what this one does:
    /// the squared size of tolerances counts twice in a limit.
    pub undeclared: f64,
    /// Rate at which a job of healthy channels may have one beyond its limit, and a complete model a gap beyond its.
    pub false_rate: f64,
    /// Share of an effect's own power that its form may leave: stretch is integrated from noisy accelerations and nonlinear terms are formed
    /// from it, to about a fifth of their amplitude at the worst (the lower band edge). A second function of the stretch of one spring must
    /// take as much beside the first, since the two are one law of force.
    pub form: f64,
    /// Share of what other effects of the vehicle take that a further one must take beside them: forms are made from noisy stretch to about
    /// a twentieth of their amplitude within the band, and what a form leaves of itself looks like another one.
    pub next_form: f64,
    /// Scatter of the logarithm of gains that are at fault, one sd: by some per cent; more is ever less likely.
    pub gain: f64,
    /// Scatter of delays that are at fault, s, one sd: some samples at the rates of vehicle records.
    pub delay_s: f64,
    /// Zero of a load cell, one sd, as a share of the weight on it: 1 % is what is left after a balance on the vehicle.
    pub zero_force: f64,
    /// Zero of an accelerometer, one sd, in g: 50 mg is what data sheets of capacitive sensors state.
    pub zero_g: f64,
    /// Stiffness within a gap, as a share of that beyond it, that parts free play from a stop: both are the same law, two slopes.
    pub play: f64,
    /// Gap on the data that judge, over the most that a complete model leaves there, beyond which no verdict but `unknown` is possible: three
    /// tolerances that are stated too small by half add up to as much.
    pub limits: f64,
    /// Share of the measured quantity left at which a fit has lost its way: its parameters are those of no vehicle, and no start for others.
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
    /// Every one of them.
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

    /// Each place is one of its own, and there are as many as numbers in the struct.
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
