//! Plans of Fourier transforms, kept between calls: their twiddle factors take as long as some transforms.

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use std::cell::RefCell;
use std::sync::Arc;

/// Number of lengths whose plans a thread keeps; one more length discards all of them. A job has a few: its records, padded, thinned, windowed.
const MOST: usize = 24;

struct Plans {
    planner: RealFftPlanner<f64>,
    lengths: Vec<usize>,
}

thread_local! {
    static PLANS: RefCell<Plans> = RefCell::new(Plans { planner: RealFftPlanner::new(), lengths: vec![] });
}

fn with_planner<T>(length: usize, plan: impl FnOnce(&mut RealFftPlanner<f64>) -> T) -> T {
    PLANS.with_borrow_mut(|p| {
        if !p.lengths.contains(&length) {
            if p.lengths.len() >= MOST {
                *p = Plans {
                    planner: RealFftPlanner::new(),
                    lengths: vec![],
                };
            }
            p.lengths.push(length);
        }
        plan(&mut p.planner)
    })
}

/// Returns the plan of a transform of `length` real samples.
pub fn forward(length: usize) -> Arc<dyn RealToComplex<f64>> {
    with_planner(length, |p| p.plan_fft_forward(length))
}

/// Returns the plan of a transform to `length` real samples.
pub fn inverse(length: usize) -> Arc<dyn ComplexToReal<f64>> {
    with_planner(length, |p| p.plan_fft_inverse(length))
}
