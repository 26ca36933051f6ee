//! What is missing in the samples of a record.

/// Samples of a record in which something is missing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Missing {
    /// Samples in which every gauge read.
    pub whole: u64,
    /// Samples in which some gauge gave nothing.
    pub gaps: u64,
    /// Readings too large to be strain, taken for none.
    pub impossible: u64,
    /// Samples with a gap in which a load is known all the same, by load.
    pub known_in_gaps: Vec<u64>,
}

impl Missing {
    /// None of no samples, for `k` loads.
    pub fn new(k: usize) -> Self {
        Self {
            known_in_gaps: vec![0; k],
            ..Self::default()
        }
    }

    /// How many samples there are.
    pub fn samples(&self) -> u64 {
        self.whole + self.gaps
    }

    /// Both together.
    pub fn merge(&mut self, other: &Self) {
        self.whole += other.whole;
        self.gaps += other.gaps;
        self.impossible += other.impossible;
        for (a, b) in self.known_in_gaps.iter_mut().zip(&other.known_in_gaps) {
            *a += b;
        }
    }
}
