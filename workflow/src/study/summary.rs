//! The end of a study: statistics, examples, files and report.

use std::path::PathBuf;

use armid::experiment::Sensing;
use armid::provenance::Provenance;
use armid::seed::RunNoise;
use armid::study::radkhah2007::evaluate_claims;
use armid::study::{Examples, ReportInput, RunId, RunOrder, ScoredEstimate, StudyDesign};
use armid_io::Error;
use armid_io::study::{FinishedWork, Journal, plan_text, read_study, write_provenance, write_study};
use armid_io::text::Text;

use super::answer::StudySummary;
use super::performance::{Performance, Performed};
use crate::report::{Sheet, write_report};

/// The order in which work is stored, and the place of each design in it.
type Stored = (RunOrder, Vec<usize>);

/// So many families of a study are shown against their limits.
const SHOWN_FAMILIES: usize = 8;

impl Performance<'_> {
    /// Sums up, stores everything, and writes the report.
    pub(super) fn sum_up(&self, performed: Performed) -> Result<StudySummary, Error> {
        self.observer.note("summing up");
        let Performed { designs, mut work, numbers, stored } = performed;
        let numbers = numbers.ok_or_else(|| Error::new("a part of a study cannot be summed up"))?;
        let (designs, bounds): (Vec<StudyDesign>, Vec<Vec<f64>>) =
            designs.into_iter().map(|made| (made.design, made.bound)).unzip();
        let conditions = self.setup.conditions(&designs, &bounds, &numbers).map_err(Error::new)?;
        let effect_sensitivity = self.setup.effect_sensitivity(&designs, &conditions, &numbers).map_err(Error::new)?;
        let radkhah2007 = if self.setup.plan.radkhah2007_claims {
            let arm = |sensing: &Sensing, noise: RunNoise| {
                self.first().arm(sensing, noise).map_err(|error| error.to_string())
            };
            let found = evaluate_claims(self.setup, &self.first().truth, &designs, &conditions[0].findings, &arm);
            Some(found.map_err(Error::new)?)
        } else {
            None
        };
        let examples = self.examples(&designs, &mut work, &stored)?;
        let result = self.setup.result(self.provenance(), designs, bounds, conditions, effect_sensitivity, radkhah2007);
        let input = ReportInput { result, examples };
        write_study(self.output, &input)?;
        write_provenance(self.output, rayon::current_num_threads())?;
        let (runs, failed) = (self.order.len(), numbers.failed());
        // Where every run failed there is nothing to draw; the rows and the summary say how each ended.
        let report: Option<PathBuf> =
            if failed < runs { Some(write_report(&self.output.join("report"), &input, Sheet::Screen)?) } else { None };
        work.remove()?;
        Ok(StudySummary { result: input.result, runs, failed, report, looks: None })
    }

    /// Is this very study stored, whole: its plan, on its robot, by this version?
    pub(super) fn is_stored(&self) -> bool {
        let of_plan = || {
            let stored = Text::read(&self.output.join("study.toml")).ok();
            stored.is_some_and(|stored| plan_text(&self.setup.plan).is_ok_and(|text| text == *stored.content))
        };
        let of_robot = || read_study(self.output).is_ok_and(|input| input.result.provenance == self.provenance());
        !self.output.join(Journal::NAME).exists() && of_plan() && of_robot()
    }

    /// What produces the results.
    fn provenance(&self) -> Provenance {
        let seed = self.setup.plan.seed;
        Provenance::new(self.setup.robot.name(), self.robot_text, Some(seed))
    }

    /// The best design of each family against its limits, and the first validation experiment against what a median
    /// run of the best one predicts.
    fn examples(&self, designs: &[StudyDesign], work: &mut FinishedWork, stored: &Stored) -> Result<Examples, Error> {
        let best = |family: usize| {
            let of_family = designs.iter().enumerate().filter(|(_, design)| design.family == family);
            of_family.min_by(|(_, a), (_, b)| a.own_value().total_cmp(&b.own_value()))
        };
        let families = self.setup.plan.designs.len().min(SHOWN_FAMILIES);
        let limits =
            (0..families).filter_map(best).map(|(index, design)| self.setup.limit_example(index, design)).collect();
        let shown = match best(0) {
            Some((index, design)) => {
                self.first_estimate(index, work, stored)?.map(|(run, estimate)| (design, run, estimate))
            }
            None => None,
        };
        let prediction = match shown {
            Some((design, run, estimate)) => {
                let seed = self.setup.plan.seed.child("validation experiment", 0);
                let simulated = self.first().with_truth(self.setup.truth(run));
                let mut arm = simulated.arm(&Sensing::default(), seed.of_run(0)).map_err(Error::new)?;
                let trajectory = self.setup.validation.random.first();
                let samples = trajectory.and_then(|trajectory| self.setup.samples(trajectory, &mut *arm).ok());
                samples.map(|samples| self.setup.prediction_example(design, &estimate, &samples))
            }
            None => None,
        };
        Ok(Examples { limits, prediction })
    }

    /// Number and last estimate of the first run of a design that gave one under the first condition.
    fn first_estimate(
        &self,
        design: usize,
        work: &mut FinishedWork,
        (order, places): &Stored,
    ) -> Result<Option<(u64, ScoredEstimate)>, Error> {
        for run in 0..self.order.runs(design) as u64 {
            let found = work.run(order.position(RunId { design: places[design], condition: 0, run }))?;
            if let Some((outcome, _)) = found.filter(|(outcome, _)| outcome.failure.is_none()) {
                let last = outcome.estimates.into_iter().rev().find(|estimate| estimate.score.is_some());
                return Ok(last.map(|estimate| (run, estimate)));
            }
        }
        Ok(None)
    }
}
