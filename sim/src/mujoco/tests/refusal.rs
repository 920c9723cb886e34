//! What cannot be simulated is refused with its reason, and it is what MuJoCo itself refuses.

use armid::conformance::chains;
use armid::dynamics::TermError;
use armid::model::StandardParameters;
use armid::model::term::{COULOMB, ROTOR};
use armid::seed::Seed;
use armid::spatial::Inertia;
use nalgebra::{Matrix3, Rotation3, Vector3};
use rand::RngExt;

use super::robots;
use crate::mujoco::MujocoModel;
use crate::{MujocoError, MujocoPlant, mjcf};

/// A planar arm whose second link is as given.
fn with_second(link: Inertia) -> Result<String, MujocoError> {
    let mut parameters = StandardParameters::zero(2);
    parameters.links[0] = Inertia::from_com(1.0, Vector3::zeros(), Matrix3::identity());
    parameters.links[1] = link;
    mjcf(&chains::planar_2r(), &parameters)
}

#[test]
fn mujoco_refuses_the_same_inertias() {
    // Principal moments on both sides of both boundaries, in turned axes; the text of a good link carries them past us.
    let mut rng = Seed::new(34).stream("inertias", 0);
    let good = Matrix3::from_diagonal(&Vector3::new(0.25, 0.5, 0.625));
    let text = with_second(Inertia::from_com(2.0, Vector3::new(0.1, 0.0, 0.0), good)).unwrap();
    let mark = "fullinertia=\"0.25 0.5 0.625 0.0 0.0 0.0\"";
    assert_eq!(text.matches(mark).count(), 1, "{text}");
    let mut verdicts = [0, 0, 0];
    for run in 0..300 {
        let (a, b) = (rng.random_range(0.01..1.0), rng.random_range(0.01..1.0));
        let margin = [1e-3, -1e-3, 1e-9, -1e-9][run % 4];
        let moments = match run % 3 {
            0 => Vector3::new(a, b, a + b - margin),
            1 => Vector3::new(-margin * a, b, b),
            _ => Vector3::new(a, a + margin, a),
        };
        let angles = (rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0), rng.random_range(-3.0..3.0));
        let turn = Rotation3::from_euler_angles(angles.0, angles.1, angles.2).into_inner();
        let i = turn * Matrix3::from_diagonal(&moments) * turn.transpose();
        let ours = with_second(Inertia::from_com(2.0, Vector3::zeros(), i));
        let theirs = MujocoModel::compile(
            &text.replace(
                mark,
                &format!(
                    "fullinertia=\"{:?} {:?} {:?} {:?} {:?} {:?}\"",
                    i[(0, 0)],
                    i[(1, 1)],
                    i[(2, 2)],
                    i[(0, 1)],
                    i[(0, 2)],
                    i[(1, 2)]
                ),
            ),
            2,
        );
        assert_eq!(ours.is_ok(), theirs.is_ok(), "{moments:?}: {ours:?} {theirs:?}");
        match ours {
            Ok(_) => verdicts[0] += 1,
            Err(MujocoError::Triangle { link: 2, joint, eigenvalue, sum }) => {
                assert_eq!(joint, "elbow");
                assert!((eigenvalue - moments.max()).abs() < 1e-12 && sum < eigenvalue);
                verdicts[1] += 1;
            }
            Err(MujocoError::PrincipalMoment { link: 2, eigenvalue, .. }) => {
                assert!((eigenvalue - moments.min()).abs() < 1e-12 && eigenvalue <= 0.0);
                verdicts[2] += 1;
            }
            Err(other) => panic!("{other}"),
        }
    }
    assert!(verdicts.iter().all(|&count| count > 30), "{verdicts:?}");
}

#[test]
fn what_is_refused_is_named() {
    let ball = |mass| Inertia::from_com(mass, Vector3::zeros(), Matrix3::identity());
    for mass in [0.0, -1.0] {
        let found = with_second(ball(mass)).unwrap_err();
        assert_eq!(found, MujocoError::Mass { link: 2, joint: "elbow".to_owned(), mass });
    }
    assert_eq!(
        with_second(ball(0.0)).unwrap_err().to_string(),
        "link 2, moved by joint \"elbow\": its mass is 0 kg, expected one above zero"
    );
    assert!(matches!(with_second(ball(f64::NAN)), Err(MujocoError::NotFinite { value, .. }) if value.is_nan()));
    let thin = Inertia::from_com(1.0, Vector3::zeros(), Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 3.5)));
    assert_eq!(
        with_second(thin).unwrap_err().to_string(),
        "link 2, moved by joint \"elbow\": its inertia about the centre of mass has the eigenvalue 3.500000e0 kg·m², \
         expected at most the sum 3.000000e0 kg·m² of the other two"
    );

    let robot = chains::planar_2r();
    assert_eq!(
        mjcf(&robot, &StandardParameters::zero(3)).unwrap_err(),
        MujocoError::Parameters { found: 3, expected: 2 }
    );
    let mut parameters = StandardParameters::zero(2);
    parameters.links = vec![ball(1.0); 2];
    parameters.drives[1][ROTOR] = -0.1;
    assert_eq!(mjcf(&robot, &parameters).unwrap_err(), MujocoError::Rotor { joint: "elbow".to_owned(), rotor: -0.1 });
    parameters.drives[1][ROTOR] = 0.1;
    parameters.drives[0][COULOMB] = 2.0;
    let plain = robot.with_joints(|joint| joint.drive.coulomb_velocity = 0.0).unwrap();
    assert_eq!(
        MujocoPlant::new(&plain, &parameters).unwrap_err(),
        MujocoError::Term(TermError::Jump {
            joint: "shoulder".to_owned(),
            term: "Coulomb friction",
            value: 2.0,
            unit: "N·m",
            key: "coulomb_velocity_rad_s",
        })
    );
}

#[test]
fn mujoco_says_why_it_does_not_take_a_text() {
    let found = MujocoModel::compile("<mujoco><worldbody><body><joint/></body></worldbody></mujoco>", 1).unwrap_err();
    assert!(matches!(&found, MujocoError::Refused { reason } if reason.contains("mass and inertia")), "{found}");
    let found = MujocoModel::compile("<mujoco><nonsense/></mujoco>", 1).unwrap_err();
    assert!(matches!(&found, MujocoError::Refused { reason } if reason.contains("nonsense")), "{found}");
    // A free body has seven coordinates.
    let free = "<mujoco><worldbody><body><freejoint/><geom size=\"1\"/></body></worldbody></mujoco>";
    let found = MujocoModel::compile(free, 6).unwrap_err();
    assert!(matches!(&found, MujocoError::Refused { reason } if reason.contains("found 7 coordinates")), "{found}");
}

#[test]
fn names_that_xml_would_misread_are_escaped() {
    let (_, parameters) = robots::chains(1).next().unwrap();
    let mut robot = chains::planar_2r();
    let mut names = ["<a & \"b\">", "é"].into_iter();
    robot = robot.with_joints(|joint| joint.name = names.next().unwrap().to_owned()).unwrap();
    let mut own = StandardParameters::zero(2);
    own.links = vec![parameters.links[0]; 2];
    MujocoModel::new(&robot, &own).unwrap_or_else(|fault| panic!("{fault}"));
}
