//! Random numbers that are equal in every run of a test.
#![allow(dead_code, reason = "no test draws all kinds")]

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Returns a normal random number of mean 0 and standard deviation 1 (Box and Muller).
pub fn draw_normal(random: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (
        random.random_range(1e-300..1.0),
        random.random_range(0.0..1.0),
    );
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// Generator without a crate: linear congruential, with Knuth's constants.
pub struct Numbers(pub u64);

impl Numbers {
    /// Returns a uniform random number between -1 and 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Returns half of the sum of twelve numbers, which is normal with standard deviation 1 except for the far tails.
    pub fn draw_normal(&mut self) -> f64 {
        (0..12).map(|_| 0.5 * self.next()).sum()
    }
}

/// Splitmix64 by Steele, Lea and Flood. Any seed is suitable.
pub struct Splitmix(pub u64);

impl Splitmix {
    /// Increment of the state for each number.
    pub const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

    /// Returns a uniform random number between -1 and 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(Self::STEP);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}
