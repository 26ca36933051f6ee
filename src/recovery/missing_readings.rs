//! Counts the missing readings in the samples of a record.

/// Numbers of samples of a record with and without missing readings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MissingReadings {
    /// Number of samples in which every gauge has a reading.
    pub whole: u64,
    /// Number of samples in which a gauge has no reading.
    pub gaps: u64,
    /// Readings too large to be strain, which count as missing.
    pub impossible: u64,
    /// Samples with a gap in which a load is known nevertheless, by load.
    pub known_in_gaps: Vec<u64>,
}

impl MissingReadings {
    /// Returns the counts of an empty record, for `k` loads.
    pub fn new(k: usize) -> Self {
        Self {
            known_in_gaps: vec![0; k],
            ..Self::default()
        }
    }

    /// Returns the number of samples.
    pub fn samples(&self) -> u64 {
        self.whole + self.gaps
    }

    /// Adds the numbers of `other`.
    pub fn merge(&mut self, other: &Self) {
        self.whole += other.whole;
        self.gaps += other.gaps;
        self.impossible += other.impossible;
        for (a, b) in self.known_in_gaps.iter_mut().zip(&other.known_in_gaps) {
            *a += b;
        }
    }
}
