//! A mapping that corrects a mistake.

use armid::diagnosis::Mistake;

use super::{ColumnMap, Mapping, Quantity, Unit};

/// The mapping by which a log was read, with the columns of every joint written out, corrected of a mistake: what `--map` is to
/// say. `None` where the data do not show one correction, or it is none of the mapping.
#[must_use]
pub(crate) fn corrected(read_as: &Mapping, columns: &[(Quantity, Vec<String>)], mistake: &Mistake) -> Option<Mapping> {
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
        Mistake::MotorAngles
        | Mistake::PositionUnit { .. }
        | Mistake::NoEffort { .. }
        | Mistake::MotorTorques
        | Mistake::EffortUnit { .. }
        | Mistake::Gravity { .. }
        | Mistake::EitherSign { .. }
        | Mistake::PositionScale { .. }
        | Mistake::EffortScale { .. }
        | Mistake::AtRest { .. } => return None,
    }
    Some(mapping)
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
        for (mistake, wanted) in [
            (Mistake::JointsSwapped { joints: [2, 3] }, "t=#1, q=a/c/b deg sign=-1, tau=#5/#7/#6"),
            (Mistake::PositionsSwapped { joints: [1, 3] }, "t=#1, q=c/b/a deg sign=-1, tau=#[5-7]"),
            (Mistake::EffortsSwapped { joints: [1, 2] }, "t=#1, q=a/b/c deg sign=-1, tau=#6/#5/#7"),
            (Mistake::PositionSign { joint: 2 }, "t=#1, q=a/b/c deg sign=-1/1/-1, tau=#[5-7]"),
            (Mistake::EffortSign { joint: 3 }, "t=#1, q=a/b/c deg sign=-1, tau=#[5-7] sign=1/1/-1"),
            (
                Mistake::ZeroOffset { joint: 1, degrees: -90.0 },
                "t=#1, q=a/b/c deg sign=-1 offset_deg=-90/0/0, tau=#[5-7]",
            ),
        ] {
            let found = corrected(&read_as, &columns, &mistake).unwrap().text();
            assert_eq!(found, wanted);
            assert!(Mapping::parse(&found).is_ok());
        }
        assert_eq!(corrected(&read_as, &columns, &Mistake::EitherSign { joint: 1 }), None);
    }
}
