//! A load that a design is made for, on the command line.

use armid::spatial::Inertia;
use armid_io::Error;

/// Radius of gyration of the heaviest load about its centre of mass, m.
const GYRATION: f64 = 0.05;

/// The heaviest load.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct PayloadArguments {
    /// Made for a load on the last link: its ten parameters are asked for, and torque and current hold their limits without it
    /// and with this mass, kg, of which nothing heavier may be put on
    #[arg(long, value_name = "KG", conflicts_with_all = ["criterion", "prior", "freeze", "expect", "predict"])]
    payload: Option<f64>,
    /// Centre of mass of the heaviest load in the frame of the last link, m
    #[arg(long, value_name = "X,Y,Z", requires = "payload", default_value = "0,0,0", value_parser = centre)]
    payload_centre: Centre,
}

impl PayloadArguments {
    /// The heaviest load as a body in the frame of the last link.
    pub(crate) fn load(&self) -> Result<Option<Inertia>, Error> {
        let Some(mass) = self.payload else { return Ok(None) };
        if !(mass.is_finite() && mass > 0.0) {
            return Err(Error::new(format!("--payload is {mass}, expected a finite mass above zero, kg")));
        }
        Ok(Some(Inertia::with_gyration(mass, self.payload_centre.0, GYRATION)))
    }

    /// Where its centre of mass is, m.
    pub(crate) const fn centre(&self) -> [f64; 3] {
        self.payload_centre.0
    }
}

/// A point, m.
#[derive(Clone, Copy, Debug)]
struct Centre([f64; 3]);

/// `0,0,0.1` as three numbers.
fn centre(text: &str) -> Result<Centre, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) if [x, y, z].iter().all(|x| x.is_finite()) => Ok(Centre([x, y, z])),
        _ => Err("expected three numbers, as 0,0,0.1".to_owned()),
    }
}
