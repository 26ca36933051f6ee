//! Inputs, results, limits and errors of a response.

use thiserror::Error;

/// Motion of a body that is known.
#[derive(Clone, Debug, PartialEq)]
pub enum PrescribedMotion {
    /// Acceleration of each motion of the body. Velocity and displacement are its integrals from rest.
    Accelerations(Vec<Vec<f64>>),
    /// Displacement of each motion of the body.
    Displacements(Vec<Vec<f64>>),
}

/// Inputs of a response, at one sample rate.
#[derive(Clone, Debug, PartialEq)]
pub struct Inputs {
    /// Samples per second.
    pub rate_hz: f64,
    /// Force of each wheel on its body, upwards, about its static load; `None` if it is not prescribed.
    pub forces: Vec<Option<Vec<f64>>>,
    /// Known motion of each body; `None` for a body that moves freely.
    pub motions: Vec<Option<PrescribedMotion>>,
    /// Link of the tyre of each wheel; `None` for a wheel without a tyre.
    pub tyres: Vec<Option<usize>>,
}

/// Limits of a response, each with its reason.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResponseRules {
    /// Least number of samples in a period of the fastest mode. With ten, the cubic curve follows a sine to 0.1 % of its amplitude.
    pub samples_per_period: f64,
    /// Largest change of a result, relative to its largest value, when the steps are halved. It is far below the error of any parameter.
    pub settled: f64,
    /// Most steps a sample. More are needed only if a force jumps, for example by friction with a very small velocity.
    pub most_steps: usize,
}

impl Default for ResponseRules {
    fn default() -> Self {
        Self {
            samples_per_period: 10.0,
            settled: 1e-6,
            most_steps: 512,
        }
    }
}

/// Response of every body, link and wheel, sampled like the inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    /// Displacement, `[body][motion][sample]`, from the position at rest.
    pub displacement: Vec<Vec<Vec<f64>>>,
    /// Velocity.
    pub velocity: Vec<Vec<Vec<f64>>>,
    /// Acceleration; NaN where the displacement is an input.
    pub acceleration: Vec<Vec<Vec<f64>>>,
    /// Stretch of each link, `[link][sample]`.
    pub stretch: Vec<Vec<f64>>,
    /// Rate of the stretch of each link.
    pub rate: Vec<Vec<f64>>,
    /// Force of the terms of each link that depend on stretch, positive in tension.
    pub spring: Vec<Vec<f64>>,
    /// Force of the terms of each link that depend on the rate, positive in tension.
    pub damper: Vec<Vec<f64>>,
    /// Force of each wheel on its body, upwards, about its static load; `None` if the model does not determine it.
    pub wheels: Vec<Option<Vec<f64>>>,
    /// Highest natural frequency of the bodies that move freely, Hz; 0 without springs.
    pub fastest_hz: f64,
    /// Runge-Kutta steps a sample; `None` for exact integration.
    pub steps: Option<usize>,
    /// Change of the results, relative to their largest value, when the steps were halved for the last time; 0 for exact integration.
    pub step_error: f64,
}

/// Why a response cannot be computed.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ResponseError {
    /// A body without usable inertia.
    #[error("the inertia of body `{0}` is not positive")]
    Inertia(String),
    /// A term without an equation.
    #[error("link `{0}` has inertance, which cannot be simulated")]
    Inertance(String),
    /// Every motion is an input.
    #[error("the motion of every body is prescribed: no motion remains to be simulated")]
    NothingFree,
    /// Histories of different length, or of less than two samples.
    #[error("an input has {found} samples, expected {expected}")]
    Length {
        /// Samples found.
        found: usize,
        /// Samples of the first input, at least 2.
        expected: usize,
    },
    /// Too few samples in a period of the fastest mode.
    #[error(
        "the sample rate is {rate_hz:.4} Hz, but the fastest mode has {fastest_hz:.4} Hz: it needs {needed_hz:.4} Hz"
    )]
    TooCoarse {
        /// Samples per second.
        rate_hz: f64,
        /// Frequency of the fastest mode, Hz.
        fastest_hz: f64,
        /// Least sample rate, Hz.
        needed_hz: f64,
    },
    /// A motion that grows beyond bounds.
    #[error("the simulated motion grows beyond bounds at {at_s:.3} s")]
    Diverged {
        /// When.
        at_s: f64,
    },
    /// Steps that cannot be made short enough.
    #[error(
        "with {steps} steps a sample, results still change by {change:.1e} of their largest value"
    )]
    Unsettled {
        /// Steps a sample.
        steps: usize,
        /// Relative change of the result.
        change: f64,
    },
}
