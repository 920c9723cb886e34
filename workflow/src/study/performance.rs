//! A study being performed: designs and runs on all cores, each kept in a journal as soon as it is finished.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex};
use std::time::Instant;

use armid::observer::{Observer, Work};
use armid::provenance::sha256;
use armid::study::{MeasuredMotions, PlannedDesign, RunId, RunOrder, StudyDesign, StudySetup};
use rayon::prelude::*;

use armid_io::Error;
use armid_io::output::write_text;
use armid_io::study::{FinishedWork, MadeDesign, NumberFile, RowFiles, check_output, plan_text};
use armid_sim::SimulatedArm;

use super::part::{Part, Stage, make_designs};
use crate::counter::{Counter, Latch};

/// Runs that are begun before the rows of those before them are written: enough that teams of runs on one arm are full.
const WINDOW: usize = 8192;

/// One study being performed.
pub(super) struct Performance<'a> {
    pub(super) setup: &'a StudySetup,
    pub(super) arms: &'a [SimulatedArm],
    pub(super) robot_text: &'a str,
    pub(super) order: RunOrder,
    pub(super) output: &'a Path,
    pub(super) part: Part,
    /// So many starts of each family are wanted.
    pub(super) starts: usize,
    pub(super) observer: &'a dyn Observer,
    /// What the arm of each condition and truth measures on fresh motions.
    pub(super) measured: Mutex<BTreeMap<(usize, usize), Arc<MeasuredMotions>>>,
}

/// A study whose runs are all finished.
pub(super) struct Performed {
    pub(super) designs: Vec<MadeDesign>,
    pub(super) work: FinishedWork,
    /// The numbers of all runs, whose rows are written; none of a part.
    pub(super) numbers: Option<NumberFile>,
    /// The order in which the work is stored, and the place of each design in it.
    pub(super) stored: (RunOrder, Vec<usize>),
}

impl Performance<'_> {
    /// The arm of the first condition, which single cases and bounds are taken from.
    pub(super) fn first(&self) -> &SimulatedArm {
        &self.arms[0]
    }

    /// No work yet. The text of the plan decides the rows: stored work with another one belongs to another study.
    pub(super) fn no_work(&self) -> Result<FinishedWork, Error> {
        Ok(FinishedWork::new(self.setup, &sha256(&plan_text(&self.setup.plan)?)))
    }

    /// Begins the journal in the output folder, or goes on with it; the plan stands beside it.
    pub(super) fn begin(&self, work: &mut FinishedWork, resume: bool) -> Result<(), Error> {
        check_output(self.output, &self.setup.plan, &self.setup.own)?;
        work.begin(self.output, resume, self.setup)?;
        write_text(&self.output.join("study.toml"), &plan_text(&self.setup.plan)?)?;
        if let Some(note) = work.note() {
            self.observer.note(&note);
        }
        Ok(())
    }

    /// How many planned runs are not finished.
    pub(super) fn missing(&self, work: &FinishedWork) -> usize {
        let wanted = self.wanted();
        (0..self.order.len()).filter(|&position| self.is_wanted(&wanted, position) && !work.holds(position)).count()
    }

    /// Which designs are wanted.
    fn wanted(&self) -> Vec<bool> {
        self.setup.designs().iter().map(|design| design.start < self.starts).collect()
    }

    /// Does the run at a position belong to this part and to the designs that are wanted?
    fn is_wanted(&self, designs: &[bool], position: usize) -> bool {
        self.part.holds(position) && designs[self.order.id(position).design]
    }

    /// Makes the designs of this part that are missing, and says whether all are there.
    pub(super) fn perform_designs(&self, work: FinishedWork) -> Result<bool, Error> {
        let missing = |work: &FinishedWork| -> Vec<usize> {
            let designs = work.designs().iter().enumerate();
            designs.filter(|(index, made)| self.part.holds(*index) && made.is_none()).map(|(index, _)| index).collect()
        };
        let mine = missing(&work);
        let work = Mutex::new(work);
        self.make_designs(mine, &work)?;
        Ok(missing(&work.into_inner().map_err(Error::new)?).is_empty())
    }

    /// Makes the designs, where it is not the stage of the runs alone, and performs the runs that are missing; of the whole
    /// study the rows are written on the way. `None` where interrupted.
    pub(super) fn perform(&self, work: FinishedWork) -> Result<Option<Performed>, Error> {
        let designs = work.designs();
        let missing: Vec<usize> = (0..designs.len()).filter(|&index| designs[index].is_none()).collect();
        if self.part.stage == Some(Stage::Runs) && !missing.is_empty() {
            let message = format!(
                "{} of {} designs are not there, expected all of them in the folder of designs",
                missing.len(),
                designs.len()
            );
            return Err(Error::new(message).help(make_designs()));
        }
        let work = Mutex::new(work);
        self.make_designs(missing, &work)?;
        let designs = work.lock().map_err(Error::new)?.designs().iter().cloned().collect::<Option<Vec<MadeDesign>>>();
        let Some(made) = designs else { return Ok(None) };
        let mut rows = if self.part.is_whole() {
            let seconds: Vec<f64> = made.iter().map(|made| made.seconds).collect();
            Some(RowFiles::create(self.output, self.setup, &seconds)?)
        } else {
            None
        };
        let designs: Vec<Option<MadeDesign>> = made.iter().cloned().map(Some).collect();
        if !self.perform_runs(&designs, &work, rows.as_mut())? {
            return Ok(None);
        }
        let numbers = rows.map(RowFiles::finish).transpose()?;
        let stored = (self.order.clone(), (0..made.len()).collect());
        Ok(Some(Performed { designs: made, work: work.into_inner().map_err(Error::new)?, numbers, stored }))
    }

    /// Makes the designs that are wanted and performs their runs; `None` where interrupted.
    pub(super) fn perform_some(&self, work: FinishedWork) -> Result<Option<FinishedWork>, Error> {
        let wanted = self.wanted();
        let made = work.designs();
        let missing = (0..made.len()).filter(|&index| wanted[index] && made[index].is_none()).collect();
        let work = Mutex::new(work);
        self.make_designs(missing, &work)?;
        let designs = work.lock().map_err(Error::new)?.designs().to_vec();
        if (0..designs.len()).any(|index| wanted[index] && designs[index].is_none()) {
            return Ok(None);
        }
        let complete = self.perform_runs(&designs, &work, None)?;
        Ok(if complete { Some(work.into_inner().map_err(Error::new)?) } else { None })
    }

    /// Makes the designs at these places.
    fn make_designs(&self, missing: Vec<usize>, work: &Mutex<FinishedWork>) -> Result<(), Error> {
        let planned = self.setup.designs();
        let counter = Counter::new(self.observer, Work::Designs, missing.len());
        missing.into_par_iter().filter(|_| counter.goes_on()).try_for_each(|index| -> Result<(), Error> {
            let begin = Instant::now();
            let (PlannedDesign { family, start }, latch) = (planned[index], Latch::new(self.observer));
            let mut sequence = self.setup.designs_of_sequence(family, start, &latch).map_err(Error::new)?;
            if latch.has_ended() {
                return Ok(());
            }
            let bound = self.bound(&sequence)?;
            let design = sequence.pop().ok_or_else(|| Error::new("a sequence without designs"))?;
            let made = MadeDesign { design, bound, seconds: begin.elapsed().as_secs_f64() };
            work.lock().map_err(Error::new)?.keep_design(index, made)?;
            counter.add();
            Ok(())
        })
    }

    /// The bound after the experiments of all designs of a sequence.
    fn bound(&self, sequence: &[StudyDesign]) -> Result<Vec<f64>, Error> {
        let mut exact = Vec::new();
        for design in sequence {
            let plan = self.setup.experiment(&design.trajectory);
            match self.first().exact_period(&plan) {
                Ok(states) => exact.push(states),
                // A motion that runs away has no bound; its runs say why.
                Err(_) => return Ok(vec![f64::INFINITY; self.setup.base.rank()]),
            }
        }
        Ok(self.setup.bound_of_sequence(&exact))
    }

    /// Performs the runs of this part that are missing, in windows of their order: while one is performed, the rows of the one
    /// before it are written. Whether all runs are there.
    fn perform_runs(
        &self,
        designs: &[Option<MadeDesign>],
        work: &Mutex<FinishedWork>,
        mut rows: Option<&mut RowFiles>,
    ) -> Result<bool, Error> {
        let missing = self.missing(&*work.lock().map_err(Error::new)?);
        let counter = Counter::new(self.observer, Work::Runs, missing);
        let end = self.order.len();
        let wanted = self.wanted();
        let mut written = 0;
        for from in (0..end).step_by(WINDOW) {
            let window = from..end.min(from + WINDOW);
            let planned: Vec<RunId> = {
                let work = work.lock().map_err(Error::new)?;
                let missing =
                    window.clone().filter(|&position| self.is_wanted(&wanted, position) && !work.holds(position));
                missing.map(|position| self.order.id(position)).collect()
            };
            let (performed, wrote) = rayon::join(
                || self.perform_window(planned, designs, work, &counter),
                || write_rows(rows.as_deref_mut(), written..from, work),
            );
            wrote?;
            written = from;
            performed?;
            if !counter.goes_on() {
                break;
            }
        }
        if self.missing(&*work.lock().map_err(Error::new)?) > 0 {
            return Ok(false);
        }
        write_rows(rows, written..end, work)?;
        Ok(true)
    }

    fn perform_window(
        &self,
        planned: Vec<RunId>,
        designs: &[Option<MadeDesign>],
        work: &Mutex<FinishedWork>,
        counter: &Counter<'_>,
    ) -> Result<(), Error> {
        self.teams(planned).into_par_iter().filter(|_| counter.goes_on()).try_for_each(|team| {
            let begin = Instant::now();
            let outcomes = self.perform_team(&team, designs)?;
            // Runs that are computed together share their time.
            let seconds = begin.elapsed().as_secs_f64() / outcomes.len().max(1) as f64;
            for outcome in outcomes {
                work.lock().map_err(Error::new)?.keep_run(outcome, seconds)?;
                counter.add();
            }
            Ok(())
        })
    }
}

/// Writes the rows of the runs at these positions, all of which are finished.
fn write_rows(
    rows: Option<&mut RowFiles>,
    positions: std::ops::Range<usize>,
    work: &Mutex<FinishedWork>,
) -> Result<(), Error> {
    let Some(rows) = rows else { return Ok(()) };
    for position in positions {
        let run = work.lock().map_err(Error::new)?.run(position)?;
        let (outcome, seconds) =
            run.ok_or_else(|| Error::new(format!("run {position} is not among the finished ones")))?;
        rows.add(&outcome, seconds)?;
    }
    Ok(())
}
