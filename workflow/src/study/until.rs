//! A study that ends where an interval is narrow enough: `--until`.

use armid::study::{PlannedDesign, RunId, RunNumber, StoppingRule};
use armid_io::Error;
use armid_io::study::{FinishedWork, RowFiles};

use super::answer::StudySummary;
use super::looks::Looks;
use super::performance::{Performance, Performed};

impl Performance<'_> {
    /// Performs starts until the rule is met at a look, or all of them; `None` where interrupted.
    pub(super) fn perform_until(
        &mut self,
        mut work: FinishedWork,
        rule: &StoppingRule,
        words: &str,
    ) -> Result<Option<(Looks, FinishedWork)>, Error> {
        let families = rule.families(&self.setup.plan).map_err(Error::new)?;
        let mut looks = Looks { until: words.to_owned(), looks: Vec::new(), termination: "all-starts" };
        for (starts, bound) in StoppingRule::looks(self.setup.plan.designs[families[0]].starts) {
            self.starts = starts;
            let Some(performed) = self.perform_some(work)? else { return Ok(None) };
            work = performed;
            let logs = self.pairs(families, rule, starts, &mut work)?;
            let look = StoppingRule::look(starts, bound, &logs);
            looks.looks.push(look);
            if rule.is_met(&look) {
                looks.termination = "narrow-enough";
                break;
            }
        }
        Ok(Some((looks, work)))
    }

    /// Logarithms of the ratio of each pair of starts, by the last estimator under the first condition; a pair of which one
    /// start gave no estimate has none.
    fn pairs(
        &self,
        families: [usize; 2],
        rule: &StoppingRule,
        starts: usize,
        work: &mut FinishedWork,
    ) -> Result<Vec<f64>, Error> {
        let estimator = self.setup.plan.identification.estimators.len() - 1;
        let number = RunNumber::Metric { estimator, metric: rule.metric };
        let mut logs = Vec::new();
        for start in 0..starts {
            let [first, second] = families.map(|family| self.values(family, start, number, work));
            logs.extend(StoppingRule::log_ratio(&first?, &second?));
        }
        Ok(logs)
    }

    /// One number of all runs of a start under the first condition that gave it.
    fn values(
        &self,
        family: usize,
        start: usize,
        number: RunNumber,
        work: &mut FinishedWork,
    ) -> Result<Vec<f64>, Error> {
        let design = self.setup.designs().iter().position(|&design| design == PlannedDesign { family, start });
        let design = design.ok_or_else(|| Error::new(format!("family {family} has no start {start}")))?;
        let mut values = Vec::new();
        for run in 0..self.order.runs(design) as u64 {
            let found = work.run(self.order.position(RunId { design, condition: 0, run }))?;
            values.extend(found.and_then(|(outcome, _)| number.value(&outcome, &self.setup.scorer.truths)));
        }
        Ok(values)
    }

    /// Sums up the starts that were performed, of which this study is made: its designs are the first ones of `all`.
    pub(super) fn sum_up_first(
        &self,
        all: &Performance<'_>,
        mut work: FinishedWork,
        looks: Looks,
    ) -> Result<StudySummary, Error> {
        let (here, there) = (self.setup.designs(), all.setup.designs());
        let place = |design: usize| {
            let found = there.iter().position(|&other| other == here[design]);
            found.ok_or_else(|| Error::new(format!("design {design} is none of the whole study")))
        };
        let places = (0..here.len()).map(place).collect::<Result<Vec<usize>, Error>>()?;
        let made = |&place: &usize| {
            work.designs()[place].clone().ok_or_else(|| Error::new(format!("design {place} is not made")))
        };
        let designs = places.iter().map(made).collect::<Result<Vec<_>, Error>>()?;
        let seconds: Vec<f64> = designs.iter().map(|made| made.seconds).collect();
        let mut rows = RowFiles::create(self.output, self.setup, &seconds)?;
        for position in 0..self.order.len() {
            let id = self.order.id(position);
            let stored = work.run(all.order.position(RunId { design: places[id.design], ..id }))?;
            let (mut outcome, seconds) = stored.ok_or_else(|| Error::new(format!("run {position} is not finished")))?;
            outcome.design = id.design;
            rows.add(&outcome, seconds)?;
        }
        let numbers = Some(rows.finish()?);
        looks.write(self.output)?;
        let summary = self.sum_up(Performed { designs, work, numbers, stored: (all.order.clone(), places) })?;
        Ok(StudySummary { looks: Some(looks), ..summary })
    }
}
