//! A load that a design is made for, on the command line.

use armid_io::Error;
use armid_workflow::design::HeaviestLoad;

/// The heaviest load.
#[derive(Clone, Debug, clap::Args)]
pub(crate) struct PayloadArguments {
    /// Design for a payload of at most this mass
    #[arg(long, value_name = "KG", conflicts_with_all = ["criterion", "prior", "freeze", "expect", "predict"])]
    payload: Option<f64>,
    /// Its centre of mass in the frame of the last link, m
    #[arg(long, value_name = "X,Y,Z", requires = "payload", default_value = "0,0,0", value_parser = centre)]
    payload_centre: Centre,
}

impl PayloadArguments {
    /// The heaviest load.
    pub(crate) fn heaviest(&self) -> Result<HeaviestLoad, Error> {
        let mass_kg = self.payload.unwrap_or_default();
        let load = HeaviestLoad { mass_kg, centre_m: self.payload_centre.0 };
        load.body()
            .map_err(|_| Error::new(format!("--payload is {mass_kg}, expected a finite mass above zero, kg")))?;
        Ok(load)
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
