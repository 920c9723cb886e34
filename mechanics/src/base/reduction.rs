//! The result of a reduction: what each parameter is, and K.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::method::Method;
use super::nearly_dependent::NearlyDependent;
use super::structural::BaseMotion;
use crate::linalg::{LeftToRight, RankTolerance, product};
use crate::model::ParameterId;

/// What torque reveals of one parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Category {
    /// Its column is zero: no torque shows it. `radkhah2007` set U.
    Unidentifiable,
    /// Its column is independent of all others: it is found alone. `radkhah2007` set S.
    Identifiable,
    /// It stands in the base for a combination. `radkhah2007` D_BS without S.
    Representative,
    /// It is found only within combinations that others stand for. `radkhah2007` set D.
    Combination,
}

crate::input::named! { Category {
    Unidentifiable: "unidentifiable", Identifiable: "identifiable", Representative: "representative",
    Combination: "combination"
} }

/// The base parameters of a robot: `β = K φ` with `Y φ = Y_b β`.
///
/// ```
/// # use armid_mechanics as armid;
/// use armid::base::{BaseReduction, Category, Method};
/// use armid::model::{ParameterId, ParameterKind};
/// use nalgebra::dmatrix;
/// use armid::model::term::ROTOR;
/// let ids = [ParameterKind::Izz, ParameterKind::M, ParameterKind::Term(ROTOR)].map(|kind| ParameterId { kind, index: 0 });
/// // A rotor on the joint of a link: only the sum of both inertias shows, and the mass never.
/// let base = BaseReduction::from_stack(&ids, &dmatrix![1.0, 0.0, 1.0; 2.0, 0.0, 2.0], Method::Qr);
/// assert_eq!(base.names(), ["Izz1"]);
/// assert_eq!(base.categories, [Category::Representative, Category::Unidentifiable, Category::Combination]);
/// assert!((base.beta(&[0.3, 5.0, 0.1].to_vec().into())[0] - 0.4).abs() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self", deny_unknown_fields)]
pub struct BaseReduction {
    /// All parameters in order, the columns of Y; p of them.
    pub parameters: Vec<ParameterId>,
    /// What torque reveals of each; p.
    pub categories: Vec<Category>,
    /// Columns that stand in the base, ascending; b of them.
    pub kept: Vec<usize>,
    /// K, b × p: the identity on the kept columns, zero on the unidentifiable ones.
    #[serde(with = "crate::plain::matrix")]
    pub k: DMatrix<f64>,
    /// How it was found.
    pub method: Method,
    /// How the base of the robot moves.
    pub base_motion: BaseMotion,
    /// What was left out of it because no torque sensor would see it.
    pub nearly_dependent: Option<NearlyDependent>,
}

/// Coefficients of K smaller than this are rounding and become zero, in units in which robot and motion are of size 1.
///
/// The random states leave K an error of some 1e-15 times a condition number of 1e1 to 1e4; the smallest true
/// coefficients are squares of length ratios, 1e-5 for a length of three thousandths of the arm.
pub(super) const SMALLEST_COEFFICIENT: f64 = 1e-9;

/// Coefficients this close to a whole number become that number: most are 1 or −1 by geometry.
const WHOLE: f64 = 1e-12;

// Refuses a K that is no reduced row echelon form of these parameters.
crate::plain::checked_when_read!(BaseReduction, |mut value| {
    if value.kept.is_empty() && value.k.nrows() == 0 {
        value.k = DMatrix::zeros(0, value.parameters.len());
    }
    value.check().map(|()| value)
});

/// The category of each parameter by K.
fn categories(kept: &[usize], k: &DMatrix<f64>) -> Vec<Category> {
    let mut categories: Vec<Category> = k
        .column_iter()
        .map(|column| if column.iter().all(|&x| x == 0.0) { Category::Unidentifiable } else { Category::Combination })
        .collect();
    for (row, &j) in kept.iter().enumerate() {
        let alone = k.row(row).iter().enumerate().all(|(other, &x)| other == j || x == 0.0);
        categories[j] = if alone { Category::Identifiable } else { Category::Representative };
    }
    categories
}

impl BaseReduction {
    /// Parts that fit each other: each parameter once, the kept columns ascending, the identity on them in K, nothing before
    /// them in their rows, and the categories that K states.
    fn check(&self) -> Result<(), String> {
        let (p, b) = (self.parameters.len(), self.kept.len());
        if let Some(id) =
            self.parameters.iter().enumerate().find_map(|(j, id)| self.parameters[..j].contains(id).then_some(id))
        {
            return Err(format!("parameter {id} occurs twice, expected each once"));
        }
        if self.k.shape() != (b, p) {
            let (rows, columns) = self.k.shape();
            return Err(format!("K is {rows} × {columns}, expected {b} × {p} for {b} kept columns of {p} parameters"));
        }
        if self.kept.windows(2).any(|pair| pair[0] >= pair[1]) || self.kept.last().is_some_and(|&j| j >= p) {
            return Err(format!("kept columns {:?}, expected ascending indices below {p}", self.kept));
        }
        for (row, &own) in self.kept.iter().enumerate() {
            for (j, &x) in self.k.row(row).iter().enumerate() {
                let expected = match self.kept.binary_search(&j) {
                    Ok(_) => Some(if j == own { 1.0 } else { 0.0 }),
                    Err(_) if j < own => Some(0.0),
                    Err(_) => None,
                };
                if !x.is_finite() || expected.is_some_and(|expected| x != expected) {
                    let expected = expected.map_or("a finite number".to_owned(), |expected| expected.to_string());
                    return Err(format!("K[{row}][{j}] is {x}, expected {expected}"));
                }
            }
        }
        let stated = categories(&self.kept, &self.k);
        match stated.iter().zip(&self.categories).position(|(expected, found)| expected != found) {
            Some(j) => Err(format!(
                "{} is {}, expected {} by K",
                self.parameters[j],
                self.categories[j].name(),
                stated[j].name()
            )),
            None if self.categories.len() != p => {
                Err(format!("{} categories, expected {p}, one for each parameter", self.categories.len()))
            }
            None => Ok(()),
        }
    }

    /// The reduction of a stacked regressor W (rows × p) by one left-to-right QR; the columns should be scaled so
    /// that a sound one has a length of the order of the longest.
    ///
    /// # Panics
    /// If W has not one column per parameter.
    pub fn from_stack(parameters: &[ParameterId], w: &DMatrix<f64>, method: Method) -> Self {
        assert_eq!(w.ncols(), parameters.len(), "one column per parameter");
        let qr = LeftToRight::new(w, RankTolerance::default());
        Self::from_echelon(parameters, qr.kept, qr.coefficients, method)
    }

    /// The reduction with these kept columns and this K, with coefficients that rounding has left near whole numbers put there.
    pub(super) fn from_echelon(
        parameters: &[ParameterId],
        kept: Vec<usize>,
        mut k: DMatrix<f64>,
        method: Method,
    ) -> Self {
        for x in k.iter_mut() {
            if x.abs() < SMALLEST_COEFFICIENT {
                *x = 0.0;
            } else if (*x - x.round()).abs() < WHOLE {
                *x = x.round();
            }
        }
        let categories = categories(&kept, &k);
        Self {
            parameters: parameters.to_vec(),
            categories,
            kept,
            k,
            method,
            base_motion: BaseMotion::Fixed,
            nearly_dependent: None,
        }
    }

    /// Returns this reduction with the rows and columns of some parameters, which stand at `places`, replaced by those of a reduction of them
    /// alone: for parameters that no other combines with.
    pub(super) fn with_rows(self, places: &[usize], part: &Self) -> Self {
        let mut rows: Vec<(usize, Option<usize>)> =
            self.kept.iter().enumerate().filter(|(_, j)| !places.contains(j)).map(|(row, &j)| (j, Some(row))).collect();
        rows.extend(part.kept.iter().map(|&j| (places[j], None)));
        rows.sort_unstable();
        let kept: Vec<usize> = rows.iter().map(|&(j, _)| j).collect();
        let mut k = DMatrix::zeros(kept.len(), self.parameters.len());
        let mut parts = 0..part.rank();
        for (row, &(_, own)) in rows.iter().enumerate() {
            if let Some(own) = own {
                k.row_mut(row).copy_from(&self.k.row(own));
            } else if let Some(from) = parts.next() {
                for (j, &place) in places.iter().enumerate() {
                    k[(row, place)] = part.k[(from, j)];
                }
            }
        }
        Self { categories: categories(&kept, &k), kept, k, ..self }
    }

    /// Multiplies each parameter's unit: `units[j]` old units of parameter j make a new one, so that
    /// `K_bj → K_bj · units[b] / units[j]`.
    pub(crate) fn with_units(mut self, units: &[f64]) -> Self {
        for (row, &b) in self.kept.iter().enumerate() {
            for (j, unit) in units.iter().enumerate() {
                if j != b && self.k[(row, j)] != 0.0 {
                    self.k[(row, j)] *= units[b] / unit;
                }
            }
        }
        self
    }

    /// Number of base parameters b, the rank of the regressor.
    pub fn rank(&self) -> usize {
        self.kept.len()
    }

    /// `β = K φ`, length b, for the standard parameters φ of length p.
    ///
    /// # Panics
    /// If φ has not p entries.
    pub fn beta(&self, phi: &DVector<f64>) -> DVector<f64> {
        assert_eq!(phi.len(), self.parameters.len(), "one value per parameter");
        let column = DMatrix::from_column_slice(phi.len(), 1, phi.as_slice());
        DVector::from_column_slice(product(&self.k, &column).as_slice())
    }

    /// Name of each base parameter: that of the parameter which stands for it.
    pub fn names(&self) -> Vec<String> {
        self.kept.iter().map(|&j| self.parameters[j].to_string()).collect()
    }

    /// The parameters that make up base parameter `row`, with their coefficients, in order; the first is the one which
    /// stands for it, with coefficient 1.
    pub fn terms(&self, row: usize) -> Vec<(ParameterId, f64)> {
        let coefficients = self.k.row(row);
        self.parameters.iter().copied().zip(coefficients.iter().copied()).filter(|&(_, c)| c != 0.0).collect()
    }

    /// The kept columns of a stacked regressor: W (rows × p) → W_b (rows × b).
    ///
    /// # Panics
    /// If W has not p columns.
    pub fn select_columns(&self, w: &DMatrix<f64>) -> DMatrix<f64> {
        assert_eq!(w.ncols(), self.parameters.len(), "one column per parameter");
        w.select_columns(&self.kept)
    }

    /// How many parameters are of a category.
    pub fn count(&self, category: Category) -> usize {
        self.categories.iter().filter(|&&other| other == category).count()
    }
}
