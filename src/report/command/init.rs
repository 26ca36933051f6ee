//! Files and words of `init`.

use super::Report;
use crate::app::fault::Faults;
use crate::app::init::Proposal;
use crate::app::outcome::Outcome;
use crate::app::output::Output;
use crate::report::page::Page;

impl Report for Outcome<Proposal> {
    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        Ok(out.write_bytes(self.job, self.text.as_bytes())?)
    }

    fn page(&self) -> Option<Page> {
        None
    }

    fn words(&self) -> String {
        if self.loads.is_empty() && !self.placeable && self.inputs.is_empty() {
            return format!("{}: read it, and name your files in it\n", self.job);
        }
        let n = self.loads.len();
        let plural = if n == 1 { "" } else { "s" };
        let what = format!("{}: {n} load{plural} proposed", self.job);
        match self.placeable {
            true => format!(
                "{what}; read it, correct units and loads, then run `place {}`\n",
                self.path.display()
            ),
            false => format!("{what}; gauges can't be placed by it as it is: see the findings\n"),
        }
    }
}
