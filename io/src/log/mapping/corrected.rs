//! A mapping that corrects a mistake.

use armid::diagnosis::Mistake;
use armid::model::Robot;

use super::{ColumnMap, Mapping, Quantity, Unit};

/// Part by which a factor may be off the unit that it stands for.
const SAME_UNIT: f64 = 0.03;

/// The largest gear that joints have.
const LARGEST_GEAR: f64 = 500.0;

/// The mapping by which a log was read, with the columns of every joint written out, corrected of a mistake: what `--map` is to
/// say. Several where the data do not show which, the likeliest first; none where the correction is none of the mapping.
pub(crate) fn corrected(
    read_as: &Mapping,
    columns: &[(Quantity, Vec<String>)],
    mistake: &Mistake,
    robot: &Robot,
) -> Vec<Mapping> {
    if let Mistake::EitherSign { joint } = *mistake {
        let either = [Mistake::EffortSign { joint }, Mistake::PositionSign { joint }];
        return either.iter().flat_map(|mistake| corrected(read_as, columns, mistake, robot)).collect();
    }
    one(read_as, columns, mistake, robot).into_iter().collect()
}

/// The only correction.
fn one(read_as: &Mapping, columns: &[(Quantity, Vec<String>)], mistake: &Mistake, robot: &Robot) -> Option<Mapping> {
    // A change of commands or positions alone would change the torque that is made of both.
    if read_as.columns(Quantity::Command).is_some() {
        return None;
    }
    let mut mapping = read_as.clone();
    let (positions, efforts) = ([Quantity::Position, Quantity::Velocity], [Quantity::Current, Quantity::Torque]);
    let change = |mapping: &mut Mapping, of: &[Quantity], with: &dyn Fn(&mut ColumnMap)| {
        mapping.columns.iter_mut().filter(|map| of.contains(&map.quantity)).for_each(with);
    };
    let dof = columns.iter().find(|(quantity, _)| *quantity == Quantity::Position)?.1.len();
    let exchange = |mapping: &mut Mapping, of: &[Quantity], [a, b]: [usize; 2]| {
        for map in mapping.columns.iter_mut().filter(|map| of.contains(&map.quantity)) {
            let Some((_, names)) = columns.iter().find(|(quantity, _)| *quantity == map.quantity) else { continue };
            let mut names = names.clone();
            if a.max(b) <= names.len() && a.min(b) > 0 {
                names.swap(a - 1, b - 1);
            }
            map.columns = names.join("/");
        }
    };
    match *mistake {
        Mistake::Degrees => change(&mut mapping, &positions[..1], &|map| map.unit = Some(Unit::Deg)),
        Mistake::Radians => change(&mut mapping, &positions[..1], &|map| map.unit = Some(Unit::Rad)),
        Mistake::PositionSign { joint } => change(&mut mapping, &positions, &|map| turn(map, joint, dof)),
        Mistake::EffortSign { joint } => change(&mut mapping, &efforts, &|map| turn(map, joint, dof)),
        Mistake::EffortsReversed { .. } => change(&mut mapping, &efforts, &|map| {
            map.sign = Some(map.sign.as_deref().unwrap_or(&[1.0]).iter().map(|sign| -sign).collect());
        }),
        Mistake::PositionsSwapped { joints } => exchange(&mut mapping, &positions, joints),
        Mistake::EffortsSwapped { joints } => exchange(&mut mapping, &efforts, joints),
        Mistake::JointsSwapped { joints } => {
            exchange(&mut mapping, &positions, joints);
            exchange(&mut mapping, &efforts, joints);
        }
        Mistake::ZeroOffset { joint, degrees } => {
            change(&mut mapping, &positions[..1], &|map| {
                let mut offset = of_each(map.offset.as_deref(), 0.0, dof);
                if let Some(offset) = offset.get_mut(joint.wrapping_sub(1)) {
                    *offset += degrees.to_radians();
                }
                map.offset = Some(offset);
            });
        }
        Mistake::MotorAngles => change(&mut mapping, &positions, &|map| map.motor = true),
        Mistake::PositionUnit { factor } => match position_unit(read_as.columns(Quantity::Position)?, factor) {
            Some(unit) => change(&mut mapping, &positions[..1], &|map| map.unit = Some(unit)),
            None => {
                // One gear for all, to begin with; one that none has is in degrees.
                let (unit, gear) = match read_as.columns(Quantity::Position)?.unit {
                    None | Some(Unit::Rad) if factor.recip() > LARGEST_GEAR => {
                        (Some(Unit::Deg), Unit::Deg.si() / factor)
                    }
                    unit => (unit, factor.recip()),
                };
                change(&mut mapping, &positions[..1], &|map| {
                    (map.unit, map.motor, map.gear) = (unit, true, Some(vec![gear.round().max(1.0)]));
                });
            }
        },
        Mistake::MotorTorques => {
            let torque = read_as.columns(Quantity::Torque)?;
            if torque.motor {
                return None;
            }
            change(&mut mapping, &efforts, &|map| map.motor = true);
        }
        Mistake::EffortUnit { factor } => {
            let of = efforts.into_iter().find(|quantity| read_as.columns(*quantity).is_some())?;
            if factor == 1e-3 {
                let unit = if of == Quantity::Current { Unit::Ma } else { Unit::MilliNm };
                change(&mut mapping, &[of], &|map| map.unit = Some(unit));
            } else {
                // Percent of what the robot can do.
                let rated: Vec<f64> = if of == Quantity::Current {
                    robot.joints().iter().map(|joint| joint.drive.current_limit).collect()
                } else {
                    robot.joints().iter().map(|joint| joint.limits.torque).collect()
                };
                if !rated.iter().all(|rated| rated.is_finite()) {
                    return None;
                }
                change(&mut mapping, &[of], &|map| (map.unit, map.rated) = (Some(Unit::Percent), Some(rated.clone())));
            }
        }
        Mistake::NoEffort { .. }
        | Mistake::Gravity { .. }
        | Mistake::EffortsSmall { .. }
        | Mistake::EitherSign { .. }
        | Mistake::PositionScale { .. }
        | Mistake::EffortScale { .. }
        | Mistake::AtRest { .. } => return None,
    }
    Some(mapping)
}

/// The unit that makes positions `factor` times as large as they were read.
fn position_unit(map: &ColumnMap, factor: f64) -> Option<Unit> {
    let si = factor * map.unit.unwrap_or(Unit::Rad).si();
    let units = [Unit::Rad, Unit::Deg, Unit::Mrad, Unit::Rev];
    units.into_iter().find(|unit| (si / unit.si() - 1.0).abs() < SAME_UNIT)
}

/// Turns the sign of a joint, from one.
fn turn(map: &mut ColumnMap, joint: usize, dof: usize) {
    let mut sign = of_each(map.sign.as_deref(), 1.0, dof);
    if let Some(sign) = sign.get_mut(joint.wrapping_sub(1)) {
        *sign = -*sign;
    }
    map.sign = Some(sign);
}

/// A value for each joint of a list of one for all or one for each.
fn of_each(list: Option<&[f64]>, otherwise: f64, dof: usize) -> Vec<f64> {
    match list {
        Some([one]) => vec![*one; dof],
        Some(list) if list.len() == dof => list.to_vec(),
        Some(_) | None => vec![otherwise; dof],
    }
}

#[cfg(test)]
mod tests {
    use armid::diagnosis::Mistake;

    use super::{Quantity, corrected};
    use crate::log::Mapping;

    #[test]
    fn corrections_are_mappings_that_can_be_typed() {
        let read_as = Mapping::parse("t=#1, q=a/b/c deg sign=-1, tau=#[5-7]").unwrap();
        let names = |names: [&str; 3]| names.map(str::to_owned).to_vec();
        let columns = [(Quantity::Position, names(["a", "b", "c"])), (Quantity::Torque, names(["#5", "#6", "#7"]))];
        let robot = crate::robot::find("planar-2r").unwrap().robot;
        for (mistake, wanted) in [
            (Mistake::JointsSwapped { joints: [2, 3] }, "t=#1, q=a/c/b deg sign=-1, tau=#5/#7/#6"),
            (Mistake::PositionsSwapped { joints: [1, 3] }, "t=#1, q=c/b/a deg sign=-1, tau=#[5-7]"),
            (Mistake::EffortsSwapped { joints: [1, 2] }, "t=#1, q=a/b/c deg sign=-1, tau=#6/#5/#7"),
            (Mistake::PositionSign { joint: 2 }, "t=#1, q=a/b/c deg sign=-1/1/-1, tau=#[5-7]"),
            (Mistake::EffortsReversed { slope: None }, "t=#1, q=a/b/c deg sign=-1, tau=#[5-7] sign=-1"),
            (Mistake::EffortSign { joint: 3 }, "t=#1, q=a/b/c deg sign=-1, tau=#[5-7] sign=1/1/-1"),
            (
                Mistake::ZeroOffset { joint: 1, degrees: -90.0 },
                "t=#1, q=a/b/c deg sign=-1 offset_deg=-90/0/0, tau=#[5-7]",
            ),
        ] {
            let [found] = &corrected(&read_as, &columns, &mistake, &robot)[..] else { panic!("{mistake:?}") };
            let found = found.text();
            assert_eq!(found, wanted);
            assert!(Mapping::parse(&found).is_ok());
        }
        assert!(corrected(&read_as, &columns, &Mistake::NoEffort { joint: 1 }, &robot).is_empty());
    }

    /// The texts of the corrections of a log that was read by a mapping.
    fn texts(read_as: &str, mistake: &Mistake) -> Vec<String> {
        let robot = crate::robot::find("staubli-tx40").unwrap().robot;
        let read_as = Mapping::parse(read_as).unwrap();
        let names = |from: usize| (from..from + 6).map(|k| format!("#{k}")).collect::<Vec<_>>();
        let columns = [(Quantity::Position, names(2)), (Quantity::Torque, names(8))];
        let all: Vec<String> =
            corrected(&read_as, &columns, mistake, &robot).iter().map(|mapping| mapping.text()).collect();
        assert!(all.iter().all(|text| Mapping::parse(text).is_ok()), "{all:?}");
        all
    }

    #[test]
    fn either_sign_motor_sides_and_units_are_mappings_too() {
        let torque = "t=#1, q=#[2-7], tau=#[8-13]";
        let current = "t=#1, q=#[2-7], current=#[8-13]";
        assert_eq!(
            texts(torque, &Mistake::EitherSign { joint: 2 }),
            ["t=#1, q=#[2-7], tau=#[8-13] sign=1/-1/1/1/1/1", "t=#1, q=#[2-7] sign=1/-1/1/1/1/1, tau=#[8-13]"]
        );
        assert_eq!(texts(torque, &Mistake::MotorAngles), ["t=#1, q=#[2-7] motor, tau=#[8-13]"]);
        assert_eq!(texts(torque, &Mistake::MotorTorques), ["t=#1, q=#[2-7], tau=#[8-13] motor"]);
        assert!(texts(current, &Mistake::MotorTorques).is_empty());
        assert_eq!(texts(torque, &Mistake::EffortUnit { factor: 1e-3 }), ["t=#1, q=#[2-7], tau=#[8-13] mNm"]);
        assert_eq!(texts(current, &Mistake::EffortUnit { factor: 1e-3 }), ["t=#1, q=#[2-7], current=#[8-13] mA"]);
        // Percent are of what the robot file says that the joints can do.
        let [rated] = &texts(torque, &Mistake::EffortUnit { factor: 0.01 })[..] else { panic!("one correction") };
        assert!(rated.contains("tau=#[8-13] % rated="), "{rated}");
        // A factor that is no unit is that of gears.
        let of = |factor| texts("t=#1, q=#[2-7] deg, tau=#[8-13]", &Mistake::PositionUnit { factor });
        assert_eq!(of(0.0098), ["t=#1, q=#[2-7] deg motor gear=102, tau=#[8-13]"]);
        assert_eq!(of(0.0573), ["t=#1, q=#[2-7] mrad, tau=#[8-13]"]);
        let in_radians = texts(torque, &Mistake::PositionUnit { factor: 1.0_f64.to_radians() / 121.0 });
        assert_eq!(in_radians, ["t=#1, q=#[2-7] deg motor gear=121, tau=#[8-13]"]);
    }
}
