//! A log of positions and efforts.

use std::path::PathBuf;

use armid::estimation::ServoPart;
use armid::model::EffortInterface;
use armid::model::format::ChainEnds;
use armid_io::Text;
use armid_io::log::{ArrayTime, LogArrays, Mapping, Servo, find, parse_tables};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{Rows, any, check_lengths};
use crate::fault::{exception, unexpected};
use crate::robot::Robot;

/// One log, and what its own table says beside it.
#[pyclass(frozen, module = "armid._armid")]
#[derive(Clone)]
pub(crate) struct Log {
    pub(crate) log: armid_io::Log,
    /// The files, as they were named; none of arrays.
    pub(crate) paths: Vec<String>,
    pub(crate) period_s: Option<f64>,
    pub(crate) part_s: (Option<f64>, Option<f64>),
    /// Rows per second that were stated.
    pub(crate) rate_hz: Option<f64>,
    /// The robot that a table names.
    robot_name: Option<String>,
}

impl Log {
    pub(crate) fn of(log: armid_io::Log) -> Self {
        Self { log, paths: Vec::new(), period_s: None, part_s: (None, None), rate_hz: None, robot_name: None }
    }
}

/// What efforts are called.
pub(crate) fn effort(name: &str) -> PyResult<EffortInterface> {
    EffortInterface::ALL
        .into_iter()
        .find(|effort| effort.name() == name)
        .ok_or_else(|| unexpected(format!("effort is \"{name}\", expected torque or current")))
}

/// Gains, delay and what is unknown of position servos.
type ServoNumbers = (Vec<f64>, Vec<f64>, f64, Vec<String>);

/// The servos of these numbers.
fn of_servo((kp, kd, delay_s, names): ServoNumbers) -> PyResult<Servo> {
    let part = |name: &String| {
        ServoPart::parse(name).ok_or_else(|| {
            unexpected(format!(
                "unknown holds \"{name}\", expected delay, kp1, kd1 or zero1, the number being a joint's"
            ))
        })
    };
    Ok(Servo { unknown: names.iter().map(part).collect::<PyResult<_>>()?, ..Servo::new(kp, kd, delay_s) })
}

/// Whether a path is that of a table, by its name.
#[pyfunction]
pub(crate) fn is_table(path: PathBuf) -> bool {
    armid_io::log::is_table(&path)
}

#[pymethods]
impl Log {
    #[staticmethod]
    fn read(
        py: Python<'_>,
        paths: Vec<PathBuf>,
        mapping: Option<String>,
        rate_hz: Option<f64>,
        robot: Option<&Robot>,
    ) -> PyResult<Self> {
        let of = robot.map(|robot| &robot.loaded.robot);
        let found = py.detach(|| find(&paths, mapping.as_deref(), rate_hz, of, false)).map_err(exception)?;
        let (count, mut logs) = (found.logs.len(), found.logs.into_iter());
        let (Some(log), 1) = (logs.next(), count) else {
            let message = format!("the paths hold {count} logs, expected one: a list of logs goes to identify");
            return Err(unexpected(message));
        };
        if log.recording.is_some() && (mapping.is_some() || rate_hz.is_some()) {
            let message = format!("{} is a recording of armid, which states its columns and its rate itself", log.name);
            return Err(exception(armid_io::Error::mismatch(message).help("leave out map= and rate=")));
        }
        Ok(Self {
            log,
            paths: paths.iter().map(|path| path.display().to_string()).collect(),
            period_s: found.period_s,
            part_s: found.part_s,
            rate_hz,
            robot_name: found.robot,
        })
    }

    /// Of a table of text, which is no file.
    #[staticmethod]
    fn from_table(
        py: Python<'_>,
        name: String,
        text: String,
        mapping: Option<&str>,
        rate_hz: Option<f64>,
    ) -> PyResult<Self> {
        let mapping = mapping.map(Mapping::parse).transpose().map_err(exception)?;
        let table = Text::new(name, text);
        let mut log = py.detach(|| parse_tables(vec![table], mapping.as_ref(), rate_hz)).map_err(exception)?;
        log.origin.files.clear();
        Ok(Self { rate_hz, ..Self::of(log) })
    }

    #[staticmethod]
    #[allow(clippy::too_many_arguments, reason = "one for each quantity of a log")]
    fn from_arrays(
        py: Python<'_>,
        name: String,
        q: Rows<'_>,
        efforts: Rows<'_>,
        effort_name: Option<&str>,
        t: Option<PyReadonlyArray1<'_, f64>>,
        rate_hz: Option<f64>,
        qd: Option<Rows<'_>>,
        link_q: Option<Rows<'_>>,
        joints: Option<Vec<String>>,
        servo: Option<ServoNumbers>,
    ) -> PyResult<Self> {
        let dof = q.shape()[1];
        let values = |rows: &Rows<'_>, what: &str| any(rows, what, dof).map(<[f64]>::to_vec);
        check_lengths(&[("q", &q), ("the efforts", &efforts)])?;
        let optional = |rows: &Option<Rows<'_>>, what: &str| match rows {
            Some(rows) => {
                check_lengths(&[("q", &q), (what, rows)])?;
                values(rows, what).map(Some)
            }
            None => Ok::<_, PyErr>(None),
        };
        let time = match (&t, rate_hz) {
            (Some(t), None) => {
                let found = t.len();
                let stamps = t.as_slice().map_err(|_| unexpected("t is not contiguous"))?;
                if found != q.shape()[0] {
                    let expected = q.shape()[0];
                    return Err(unexpected(format!("t has {found} values, expected {expected} as q has rows")));
                }
                ArrayTime::Stamps(stamps.to_vec())
            }
            (None, Some(rate)) => ArrayTime::Rate(rate),
            _ => return Err(unexpected("expected either t=, the time of each row, or rate=, rows per second")),
        };
        let arrays = LogArrays {
            name,
            joints,
            dof,
            time,
            q: values(&q, "q")?,
            qd: optional(&qd, "qd")?,
            link_q: optional(&link_q, "q_link")?,
            effort: values(&efforts, "the efforts")?,
            effort_unit: effort_name.map(effort).transpose()?,
            servo: servo.map(of_servo).transpose()?,
        };
        let log = py.detach(|| armid_io::Log::from_arrays(arrays)).map_err(exception)?;
        Ok(Self { rate_hz, ..Self::of(log) })
    }

    /// The robot that a recording holds, or that the log's own table names.
    #[getter]
    fn robot(&self) -> PyResult<Option<Robot>> {
        if let Some(recorded) = &self.log.robot {
            let loaded = self.log.robot().map_err(exception)?;
            return Ok(Some(Robot::new(loaded, None, recorded.chain.clone())));
        }
        let Some(name) = &self.robot_name else { return Ok(None) };
        let loaded = armid_io::robot::find(name).map_err(exception)?;
        Ok(Some(Robot::new(loaded, Some(name.clone()), ChainEnds::default())))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.log.name
    }

    #[getter]
    fn joints(&self) -> Option<Vec<String>> {
        self.log.joints.clone()
    }

    #[getter]
    fn rate_hz(&self) -> f64 {
        self.log.rate_hz
    }

    #[getter]
    fn effort_name(&self) -> Option<&'static str> {
        self.log.effort_unit.map(EffortInterface::name)
    }

    #[getter]
    fn remarks(&self) -> Vec<String> {
        self.log.origin.sentences()
    }

    /// Time of each sample, s, N.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let rate = self.log.rate_hz;
        let of = self.log.segments.iter().flat_map(|of| (0..of.samples).map(move |k| of.start_s + k as f64 / rate));
        PyArray1::from_iter(py, of)
    }

    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.table(py, &self.log.q)
    }

    #[getter]
    fn effort<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.table(py, &self.log.effort)
    }
}

impl Log {
    fn table<'py>(&self, py: Python<'py>, values: &[f64]) -> PyResult<Bound<'py, PyArray2<f64>>> {
        PyArray1::from_slice(py, values).reshape([values.len() / self.log.dof, self.log.dof])
    }
}
