//! What estimates and models predict of logs.

use std::collections::BTreeMap;

use armid::calibration::{TransmissionStiffness, transmission_stiffness};
use armid::estimation::{
    BaseEstimate, Estimate, EstimationError, Identification, Model, ResidualTests, ResidualTrends, TorqueResidual,
    TorqueSeries, Validation, predict,
};
use armid::model::Columns;
use armid::regressor::JointTorqueRegressor;
use armid::remedy::{Remedy, Setting, Task};
use armid::signal::Samples;

use super::processed_log::ProcessedLog;
use crate::error::Error;

/// Torque that a model leaves unexplained in a log.
#[derive(Clone, Debug)]
pub struct LogResidual {
    /// In the part of the fit.
    pub used: TorqueResidual,
    /// In the part that is held out, where there is one.
    pub held_out: Option<TorqueResidual>,
}

/// An error of an estimate or of a model that is called `name`.
fn named(name: &str) -> impl Fn(EstimationError) -> Error {
    move |error| Error::mismatch(format!("{name}: {error}"))
}

/// Neighbours of the same columns with the same shape parameters.
fn alike(estimates: &[Estimate]) -> impl Iterator<Item = &[Estimate]> {
    estimates.chunk_by(|a, b| (&a.robot, &a.columns, &a.shape) == (&b.robot, &b.columns, &b.shape))
}

/// What base parameters stand for.
#[derive(Clone, Debug)]
pub struct BaseExpressions {
    robot: String,
    by_name: BTreeMap<String, String>,
}

impl BaseExpressions {
    /// Those of an estimate, in its order. `name` is what errors call it.
    ///
    /// # Errors
    /// [`Error`] where it is of other parameters.
    pub fn of(&self, estimate: &Estimate, name: &str) -> Result<Vec<String>, Error> {
        let of = |parameter: &BaseEstimate| {
            self.by_name.get(&parameter.name).cloned().ok_or_else(|| {
                let message = format!("{name}: \"{}\" is not a base parameter of \"{}\"", parameter.name, self.robot);
                Error::mismatch(message)
            })
        };
        estimate.base.iter().map(of).collect()
    }
}

impl ProcessedLog {
    /// Gives the robot the shape parameters of friction that an estimate was made with. `name` is what errors call the estimate.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn take_shape(&mut self, estimate: &Estimate, name: &str) -> Result<(), Error> {
        let robot = estimate.robot(&self.robot.robot, self.columns_of(estimate, name)?);
        self.robot.robot = robot.map_err(named(name))?;
        Ok(())
    }

    /// Compares what an estimate predicts with these logs. `name` is what errors call the estimate.
    ///
    /// # Errors
    /// [`Error`] where the estimate is of another robot or of other parameters.
    pub fn validate(&self, estimate: &Estimate, name: &str) -> Result<Validation, Error> {
        let columns = self.columns_of(estimate, name)?;
        let identification = Identification::new(&self.robot.robot, columns);
        identification.and_then(|of| of.validate(estimate, &self.samples)).map_err(named(name))
    }

    /// Compares what a model predicts with these logs. `name` is what errors call its file.
    ///
    /// # Errors
    /// As [`Self::model_residual`].
    pub fn validate_model(&self, model: &Model<'_>, name: &str) -> Result<Validation, Error> {
        Validation::of_model(model, &self.samples).map_err(named(name))
    }

    /// The measured torque that an estimate leaves unexplained, at the bandwidth of the settings.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn residual(&self, estimate: &Estimate, name: &str) -> Result<LogResidual, Error> {
        Ok(self.residuals(std::slice::from_ref(estimate), name)?.swap_remove(0))
    }

    /// [`Self::residual`] of each estimate. Neighbours that share a regressor evaluate it once.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn residuals(&self, estimates: &[Estimate], name: &str) -> Result<Vec<LogResidual>, Error> {
        let hz = self.settings.bandwidth_hz;
        let mut all = Vec::with_capacity(estimates.len());
        for group in alike(estimates) {
            // Columns that need the load have that of each estimate.
            let together = if self.regressor_of(&group[0], name)?.needs_load() { 1 } else { group.len() };
            for group in group.chunks(together) {
                let regressor = self.regressor_of(&group[0], name)?;
                all.extend(
                    self.in_both(|parts| TorqueResidual::of_each(group, &regressor, parts, hz).map_err(named(name)))?,
                );
            }
        }
        Ok(all)
    }

    /// Torque left unexplained by a model that was read from a file, which errors call `name`.
    ///
    /// # Errors
    /// [`Error`] where it is of another arm.
    pub fn model_residual(&self, model: &Model<'_>, name: &str) -> Result<LogResidual, Error> {
        let hz = self.settings.bandwidth_hz;
        let of =
            |parts: &[Samples]| TorqueResidual::of_model(model, parts, hz).map(|one| vec![one]).map_err(named(name));
        Ok(self.in_both(of)?.swap_remove(0))
    }

    fn in_both(
        &self,
        of: impl Fn(&[Samples]) -> Result<Vec<TorqueResidual>, Error>,
    ) -> Result<Vec<LogResidual>, Error> {
        let used = of(&self.parts)?;
        let held_out = if self.held_out.is_empty() {
            vec![None; used.len()]
        } else {
            of(&self.held_out)?.into_iter().map(Some).collect()
        };
        Ok(used.into_iter().zip(held_out).map(|(used, held_out)| LogResidual { used, held_out }).collect())
    }

    /// Measured and predicted torque of each log, and of what is held out, below the bandwidth of the settings.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn series(&self, estimate: &Estimate, name: &str, parts: &[Samples]) -> Result<Vec<TorqueSeries>, Error> {
        let regressor = self.regressor_of(estimate, name)?;
        let of = |samples: &Samples| {
            let bandwidth = self.settings.bandwidth_hz.min(0.4 * samples.rate_hz);
            TorqueSeries::new(estimate, &regressor, samples, bandwidth).map_err(named(name))
        };
        parts.iter().map(of).collect()
    }

    /// The stiffness of every transmission, by what an estimate predicts; `None` where the logs hold no positions of the links. `name` is what errors
    /// call the estimate.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn transmissions(&self, estimate: &Estimate, name: &str) -> Result<Option<Vec<TransmissionStiffness>>, Error> {
        if self.samples.link_q.is_none() {
            return Ok(None);
        }
        let robot = &self.robot.robot;
        let regressor = self.regressor_of(estimate, name)?;
        let modelled = predict(estimate, &regressor, &self.samples.states).map_err(named(name))?;
        let found = transmission_stiffness(robot, &self.samples, &modelled);
        found.map(Some).map_err(|error| Error::new(format!("{}: {error}", self.name())))
    }

    /// What the residual of each estimate shows on the equations that it was made from. Neighbours that share these share their tests.
    ///
    /// # Errors
    /// As [`Self::validate`].
    pub fn residual_trends(&self, estimates: &[Estimate], name: &str) -> Result<Vec<ResidualTrends>, Error> {
        let of_alike = |estimates: &[Estimate]| {
            let tests = self.residual_tests(&estimates[0], name)?;
            tests.trends(&self.samples, estimates).map_err(named(name))
        };
        Ok(alike(estimates).map(of_alike).collect::<Result<Vec<_>, _>>()?.concat())
    }

    fn residual_tests(&self, estimate: &Estimate, name: &str) -> Result<ResidualTests, Error> {
        let columns = self.columns_of(estimate, name)?;
        let robot = estimate.robot(&self.robot.robot, columns).map_err(named(name))?;
        let observation = self.identification_of(&robot, columns).and_then(|of| of.observation(&self.samples));
        let tests = observation.and_then(|observation| ResidualTests::new(&robot, observation));
        tests.map_err(|error| self.unestimated(&error))
    }

    /// What each base parameter of an estimate stands for, in its order.
    ///
    /// # Errors
    /// [`Error`] where the estimate is of another robot or of other parameters.
    pub fn expressions(&self, estimate: &Estimate, name: &str) -> Result<Vec<String>, Error> {
        self.base_expressions(self.columns_of(estimate, name)?)?.of(estimate, name)
    }

    /// What each base parameter of these columns stands for.
    ///
    /// # Errors
    /// [`Error`] where the robot has no base parameters.
    pub fn base_expressions(&self, columns: Columns) -> Result<BaseExpressions, Error> {
        let robot = &self.robot.robot;
        let identification = self.identification(columns);
        let identification =
            identification.map_err(|error| Error::new(format!("robot \"{}\": {error}", robot.name())))?;
        let base = identification.base();
        let named = base.names().into_iter().zip(base.expressions(robot));
        Ok(BaseExpressions { robot: robot.name().to_owned(), by_name: named.collect() })
    }

    /// By which an estimate predicts.
    fn regressor_of(&self, estimate: &Estimate, name: &str) -> Result<JointTorqueRegressor, Error> {
        let found = estimate.regressor(&self.robot.robot, self.columns_of(estimate, name)?);
        found.map_err(named(name))
    }

    fn columns_of(&self, estimate: &Estimate, name: &str) -> Result<Columns, Error> {
        let robot = &self.robot.robot;
        if estimate.robot != robot.name() {
            let message = format!("{name} is of robot \"{}\", expected \"{}\"", estimate.robot, robot.name());
            let help = Remedy::task(Task::Identify, "LOG").option(Setting::Output, "E.json");
            return Err(Error::mismatch(message).help(help.say(" makes an estimate of this robot")));
        }
        Columns::parse(&estimate.columns).ok_or_else(|| {
            let names = Columns::ALL.map(|columns| columns.to_string()).join(", ");
            Error::new(format!("{name}: columns is \"{}\", expected one of {names}", estimate.columns))
        })
    }
}
