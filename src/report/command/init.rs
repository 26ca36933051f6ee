//! Files and words of `init`.

use super::Report;
use crate::app::fault::Faults;
use crate::app::init::Proposal;
use crate::app::outcome::Outcome;
use crate::app::output::Output;

impl Report for Outcome<Proposal> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        Ok(out.write_bytes(self.job, self.text.as_bytes())?)
    }

    fn words(&self) -> String {
        format!(
            "{}: {} loads proposed; read it, correct units and loads, then run `place` on it\n",
            self.job,
            self.loads.len()
        )
    }
}
