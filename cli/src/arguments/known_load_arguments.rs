//! A load whose parameters are known, on the command line.

use armid::spatial::Inertia;
use armid_io::Error;

/// A load on the last link that was weighed and measured.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct KnownLoadArguments {
    /// Mass of the load, which is known
    #[arg(long, value_name = "KG", requires = "drive_gains", help_heading = "Payload")]
    payload_mass: Option<f64>,
    /// Its centre of mass in the frame of the last link, m
    #[arg(
        long,
        value_name = "X,Y,Z",
        requires = "drive_gains",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Payload"
    )]
    payload_centre: Option<Vec<f64>>,
    /// Its inertia about its centre, kg·m² [default: a point mass]
    #[arg(
        long,
        value_name = "XX,YY,ZZ[,XY,XZ,YZ]",
        requires = "drive_gains",
        value_delimiter = ',',
        allow_hyphen_values = true,
        help_heading = "Payload"
    )]
    payload_inertia: Option<Vec<f64>>,
}

/// What helps where the load is not known.
const UNKNOWN: &str = "weigh the load and measure where its centre is: --payload-mass 1 --payload-centre 0.02,0,0.06; \
                       `armid identify --payload` estimates an unknown load where the torque constants are known";

impl KnownLoadArguments {
    /// The load about the origin of the last link's frame.
    ///
    /// # Errors
    /// [`Error`] where mass or centre is not given, or no body has them.
    pub(crate) fn load(&self) -> Result<Inertia, Error> {
        let (Some(mass), Some(centre)) = (self.payload_mass, &self.payload_centre) else {
            let missing = if self.payload_mass.is_none() { "--payload-mass" } else { "--payload-centre" };
            let message =
                format!("the load is not known: {missing} is missing; it sets the scale of all torque constants");
            return Err(Error::new(message).help(UNKNOWN));
        };
        let fault = |message: String| Error::new(message).help(UNKNOWN);
        if !(mass.is_finite() && mass > 0.0) {
            return Err(fault(format!("--payload-mass is {mass}, expected a finite mass above zero, kg")));
        }
        let centre = three(centre)?;
        let Some(given) = &self.payload_inertia else { return Ok(Inertia::with_moments(mass, centre, [0.0; 6])) };
        let moments = match given.as_slice() {
            &[xx, yy, zz] => [xx, yy, zz, 0.0, 0.0, 0.0],
            &[xx, yy, zz, xy, xz, yz] => [xx, yy, zz, xy, xz, yz],
            other => return Err(fault(format!("--payload-inertia has {} numbers, expected 3 or 6", other.len()))),
        };
        let load = Inertia::with_moments(mass, centre, moments);
        load.check().map_err(|of| fault(format!("no body has this --payload-mass and --payload-inertia: {of}")))?;
        Ok(load)
    }
}

fn three(given: &[f64]) -> Result<[f64; 3], Error> {
    match given {
        &[x, y, z] if [x, y, z].iter().all(|x| x.is_finite()) => Ok([x, y, z]),
        other => {
            let message = format!("--payload-centre has {} numbers, expected 3 finite ones", other.len());
            Err(Error::new(message).help(UNKNOWN))
        }
    }
}
