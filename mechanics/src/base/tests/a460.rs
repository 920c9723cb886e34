//! The CRS A460 against `radkhah2007`.

use super::chains::a460;
use crate::base::{Category, Method, reduce};
use crate::model::Columns;
use crate::seed::Seed;

#[test]
fn published_counts_by_every_method() {
    // Section IV.C: 9 not identifiable, 15 in linear combinations only, 36 identifiable. 21 of the 36 alone.
    for method in Method::ALL {
        let base = reduce(&a460(), Columns::RIGID, method, Seed::new(1)).unwrap();
        assert_eq!(base.rank(), 36);
        assert_eq!(Category::ALL.map(|category| base.count(category)), [9, 21, 15, 15], "{}", method.name());
        for (id, category) in base.parameters.iter().zip(&base.categories) {
            let invisible = id.index == 0 && id.to_string() != "Iyy1";
            assert_eq!(*category == Category::Unidentifiable, invisible, "{id}");
        }
    }
}

#[test]
fn analytic_drive_columns() {
    // Axes 1 and 2 carry constants into the mass matrix that the links reach too; every other rotor, and all friction,
    // stands alone: 36 + 4, then three more for each joint.
    let arm = a460();
    for (columns, rank) in [(Columns::RIGID_ROTOR, 40), (Columns::RIGID_ROTOR_FRICTION, 58)] {
        let base = reduce(&arm, columns, Method::Structural, Seed::new(1)).unwrap();
        assert_eq!(base.rank(), rank);
        let regrouped: Vec<String> = (60..base.parameters.len())
            .filter(|&j| base.categories[j] != Category::Identifiable)
            .map(|j| base.parameters[j].to_string())
            .collect();
        assert_eq!(regrouped, ["Ia1", "Ia2"]);
    }
}

#[test]
fn analytic_tilting_the_base_reveals_two_moments_of_the_first_link() {
    // Gravity along axis 1 exerts no torque about it; across it, the two first moments of link 1 across the axis show.
    let base = reduce(
        &a460().with_gravity(nalgebra::Vector3::new(6.0, 0.0, -7.7)),
        Columns::RIGID,
        Method::Structural,
        Seed::new(1),
    )
    .unwrap();
    assert_eq!(base.rank(), 38);
    assert_eq!(base.names()[..3], ["mcx1", "mcz1", "Iyy1"]);
}

#[test]
fn analytic_formulas_of_the_regrouping() {
    // The wrist by hand: with d5 = a5 = 0 link 6 stands on link 5 turned by q6 about z5, so what is symmetric about that
    // axis goes over: m6 at d6, its moment along z, and the part of its inertia that turning does not change.
    let arm = a460();
    let base = reduce(&arm, Columns::RIGID_ROTOR, Method::Structural, Seed::new(1)).unwrap();
    let texts = base.expressions(&arm);
    for expected in [
        "Iyy1 + Iyy2 − Izz2 + Izz3 + Ia1 − Ia2",
        "m2 − Izz2/a2² + m3 + m4 + m5 + m6 − Ia2/a2²",
        "mcx2 + Izz2/a2 + Ia2/a2",
        "mcz3 + d4·m4 + mcy4 + d4·m5 + d4·m6",
        "mcz5 + d6·m6 + mcz6",
        "Iyy5 + d6²·m6 + 2·d6·mcz6 + Iyy6",
        "Izz6",
    ] {
        assert!(texts.iter().any(|text| text == expected), "{expected} is not among {texts:#?}");
    }
}
