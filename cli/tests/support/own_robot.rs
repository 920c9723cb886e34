//! A robot of somebody else's: a URDF, and tables that its controller wrote.

use std::fmt::Write;
use std::path::Path;

use super::{armid, write};

/// Six revolute joints with masses, damping and friction, a right angle rounded as exporters do, collision shapes.
pub(crate) fn urdf() -> String {
    let mut text = "<?xml version=\"1.0\"?>\n<robot name=\"lab-arm\">\n  <link name=\"world\"/>\n".to_owned();
    // Of each link: the joint's place and turn, its axis, mass, centre of mass, moment of inertia.
    let links = [
        ("0 0 0.2", "0 0 0", "0 0 1", 6.0, "0 0.02 0.1", 0.05),
        ("0 0.1 0.1", "0 1.5708 0", "0 1 0", 5.0, "0.01 0 0.2", 0.08),
        ("0 -0.1 0.4", "0 0 0", "0 1 0", 3.0, "0 0.02 0.15", 0.03),
        ("0 0 0.3", "0 1.5708 0", "1 0 0", 1.5, "0.03 0.01 0.02", 0.006),
        ("0.1 0 0", "0 0 0", "0 1 0", 1.0, "0.04 0 0.03", 0.003),
        ("0.08 0 0", "0 0 0", "1 0 0", 0.5, "0.03 0.02 0.01", 0.001),
    ];
    for (k, (xyz, rpy, axis, mass, centre, moment)) in links.into_iter().enumerate() {
        let (n, parent) = (k + 1, if k == 0 { "world".to_owned() } else { format!("link_{k}") });
        let (damping, friction) = (8.0 / n as f64, 5.0 / n as f64);
        let _ = write!(
            text,
            "  <link name=\"link_{n}\">\n    <inertial><origin xyz=\"{centre}\"/><mass value=\"{mass}\"/>\n      \
             <inertia ixx=\"{moment}\" ixy=\"0\" ixz=\"0\" iyy=\"{moment}\" iyz=\"0\" izz=\"{moment}\"/></inertial>\n  </link>\n  \
             <joint name=\"joint_{n}\" type=\"revolute\">\n    <origin xyz=\"{xyz}\" rpy=\"{rpy}\"/><parent link=\"{parent}\"/>\
             <child link=\"link_{n}\"/>\n    <axis xyz=\"{axis}\"/><limit lower=\"-2.8\" upper=\"2.8\" velocity=\"3\" \
             effort=\"{}\"/>\n    <dynamics damping=\"{damping}\" friction=\"{friction}\"/>\n  </joint>\n",
            200.0 / n as f64
        );
    }
    text + "</robot>\n"
}

/// A table of milliseconds, degrees and torques with other columns, whose arm moves by `phase`: what a controller writes.
/// The arm is that of a URDF in the folder, with rotors that the URDF does not have.
pub(crate) fn log(folder: &Path, urdf: &str, name: &str, phase: f64) {
    let rotors: String = (1..=6)
        .map(|n| {
            let rotor = 0.6 / f64::from(n * n);
            format!(
                "\n[[joint]]\nname = \"joint_{n}\"\n[joint.drive]\ncoulomb_velocity_rad_s = 0.01\n[joint.terms]\n\
                 rotor_kg_m2 = {rotor}\n"
            )
        })
        .collect();
    write(folder, "actual.toml", &format!("urdf = \"{urdf}\"\n{rotors}"));
    let mut motion = "period_s = 4.0\nharmonics = 3\n".to_owned();
    for n in 1..=6 {
        let angle = 1.9 * f64::from(n) + phase;
        let wave = |k: f64, size: f64| (size * (k * angle).cos(), size * (k * angle).sin());
        let [(a, b), (c, d), (e, f)] = [wave(1.0, 0.7), wave(2.3, 0.6), wave(3.1, 0.5)];
        let _ = write!(
            motion,
            "\n[[joint]]\nname = \"joint_{n}\"\na = [{a:?}, {c:?}, {e:?}]\nb = [{b:?}, {d:?}, {f:?}]\nq0 = 0.1\n"
        );
    }
    write(folder, "motion.toml", &motion);
    let experiment = "robot = \"actual.toml\"\ntrajectory = \"motion.toml\"\nperiods = 3\nrate_hz = 250\nramp_s = 1\n";
    let experiment = write(folder, "x.toml", experiment);
    let out = folder.join("plain.csv");
    armid(["run", &experiment, "-o", out.to_str().expect("a path in UTF-8")]).success();
    let plain = std::fs::read_to_string(&out).expect("the recording");
    assert!(plain.starts_with("t,q1,q2,q3,q4,q5,q6,tau1"), "{}", &plain[..60]);
    let mut text = "time_ms,mode".to_owned();
    for of in ["pos", "torque"] {
        (1..=6).for_each(|n| text += &format!(",{of}_{n}"));
    }
    text.push('\n');
    for line in plain.lines().skip(1) {
        let values: Vec<f64> = line.split(',').map(|value| value.parse().expect("a number")).collect();
        let _ = write!(text, "{},3", 1e3 * values[0]);
        values[1..7].iter().for_each(|q| text += &format!(",{}", q.to_degrees()));
        values[7..13].iter().for_each(|tau| text += &format!(",{tau}"));
        text.push('\n');
    }
    write(folder, name, &text);
    for name in ["actual.toml", "motion.toml", "x.toml", "plain.csv"] {
        std::fs::remove_file(folder.join(name)).expect("a file that was written");
    }
}
