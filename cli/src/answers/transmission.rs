//! What `armid identify` answers of transmissions whose motors and links are both measured.

use armid::calibration::{Measured, StiffnessVerdict, TransmissionStiffness};

use super::findings::paragraph;
use crate::terminal::{Table, number};

/// The table of all transmissions, and what it means.
pub(crate) fn transmission_text(transmissions: &[TransmissionStiffness]) -> String {
    let mut table =
        Table::of("transmission | #stiffness | #95 % |  | #rotor | #wind-up RMS, mrad (mm) | #noise of it | verdict");
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "–".to_owned());
    for one in transmissions {
        let ends = |measured: Measured| format!("{} to {}", number(measured.ci95[0]), number(measured.ci95[1]));
        table.row(vec![
            one.joint.clone(),
            or_dash(one.stiffness.map(|stiffness| number(stiffness.value))),
            or_dash(one.stiffness.map(ends)),
            one.unit.clone(),
            or_dash(one.rotor.map(|rotor| number(rotor.value))),
            number(1e3 * one.wind_up_rms),
            number(1e3 * one.wind_up_noise),
            match one.verdict {
                StiffnessVerdict::Decided => "decided",
                StiffnessVerdict::Hidden => "undecided: hidden in noise",
                StiffnessVerdict::LikeRotor => "undecided: like the rotor",
            }
            .to_owned(),
        ]);
    }
    let sentence = "Stiffness and rotor inertia (kg·m², kg) after the gear are those of the motor's own equation, with the estimated torque as the instrument of \
                    the wind-up. Hidden is a wind-up that does not answer to the torque beyond the noise and the steps of its encoders; like the rotor one \
                    whose torque the motion does not tell from the rotor's inertia.";
    format!("transmissions\n{}{}\n", table.render(2), paragraph(sentence, 2))
}
