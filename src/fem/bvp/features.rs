//! What a 1-form is at a point, as the integrals of boundary value problems see it.

use crate::fem::metric::{Geometry, gradient};
use crate::limit::Taylor;

/// The operator of a boundary value problem of 1-forms, with its energy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Operator {
    /// `Delta = d delta + delta d`, second order: `<dw, dv> + <delta w, delta v>`.
    #[default]
    HodgeLaplace,
    /// `Delta Delta`, fourth order: `<d *dw, d *dv> + <d delta w, d delta v>`.
    BiLaplace,
}

impl Operator {
    /// The derivatives that its energy takes of a form.
    pub fn order(self) -> usize {
        match self {
            Operator::HodgeLaplace => 1,
            Operator::BiLaplace => 2,
        }
    }

    /// The derivatives that its boundary terms take.
    pub fn boundary_order(self) -> usize {
        2 * self.order() - 1
    }
}

/// What there is at most: the parts of a form that pair on the boundary.
pub const MOST: usize = 8;

/// Those of a form. `b' Q a` with a symmetric `Q` is all that is ever integrated of two forms.
pub type Features = [f64; MOST];

/// Inside: `*dw` and `delta w`, or their derivatives by `s` and `t`.
pub fn inside(operator: Operator, geometry: &Geometry, w: [Taylor; 2]) -> Features {
    let (c, s) = (geometry.curl(w), geometry.codifferential(w));
    match operator {
        Operator::HodgeLaplace => [c.value(), s.value(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        Operator::BiLaplace => {
            let ([c1, c2], [s1, s2]) = (gradient(c), gradient(s));
            [c1.value(), c2.value(), s1.value(), s2.value(), 0.0, 0.0, 0.0, 0.0]
        }
    }
}

/// The energy of two forms with such features is `b' Q a`, by rows.
pub fn energy(operator: Operator, geometry: &Geometry) -> Vec<(usize, usize, f64)> {
    match operator {
        Operator::HodgeLaplace => {
            let area = geometry.area.value();
            vec![(0, 0, area), (1, 1, area)]
        }
        Operator::BiLaplace => {
            let [a, b, c] = geometry.conjugate.map(|x| x.value());
            let block = |i: usize| [(i, i, a), (i, i + 1, b), (i + 1, i, b), (i + 1, i + 1, c)];
            [block(0), block(2)].concat()
        }
    }
}

/// On the boundary, along `tangent`: the traces `w(tangent)`, `*w(tangent)`, `c = *dw`, `s = delta w`; for the
/// bi-Laplacian also what they pair with, `delta d c`, `d_n c`, `d_n s` and `-delta d s`, derivatives along the normal times
/// the length of the tangent.
pub fn traces(operator: Operator, geometry: &Geometry, w: [Taylor; 2], tangent: [f64; 2]) -> Features {
    let along = |w: [Taylor; 2]| w[0].value() * tangent[0] + w[1].value() * tangent[1];
    let (c, s) = (geometry.curl(w), geometry.codifferential(w));
    let mut features = [along(w), along(geometry.star(w)), c.value(), s.value(), 0.0, 0.0, 0.0, 0.0];
    if operator == Operator::BiLaplace {
        features[4] = geometry.laplacian0(c).value();
        features[5] = along(geometry.star(gradient(c)));
        features[6] = along(geometry.star(gradient(s)));
        features[7] = -geometry.laplacian0(s).value();
    }
    features
}

/// The traces that are prescribed: of data nothing else is used.
pub fn prescribed(operator: Operator, mut features: Features) -> Features {
    features[2 * operator.order()..].fill(0.0);
    features
}

/// The consistent terms of symmetric Nitsche: minus the boundary terms of Green's formula, both ways,
///
/// ```text
/// <dw, dv> + <delta w, delta v>           = <Delta w, v>       + int t_v *dw - n_v delta w
/// <d *dw, d *dv> + <d delta w, d delta v> = <Delta Delta w, v> + int t_v delta d c + c_v d_n c + s_v d_n s - n_v delta d s
/// ```
///
/// over the boundary, the domain to its left.
pub fn consistency(operator: Operator) -> Vec<(usize, usize, f64)> {
    let pairs: &[(usize, usize, f64)] = match operator {
        Operator::HodgeLaplace => &[(0, 2, -1.0), (1, 3, 1.0)],
        Operator::BiLaplace => &[(0, 4, -1.0), (2, 5, -1.0), (3, 6, -1.0), (1, 7, -1.0)],
    };
    pairs.iter().flat_map(|&(i, j, x)| [(i, j, x), (j, i, x)]).collect()
}

/// The weights that make integrals of squares of traces scale like the energy, whatever the size of a face: `1 / sqrt(g)`
/// for 1-forms along an edge, which is `ds / h` for a form of unit length; for the bi-Laplacian `ds / h^3`, and `ds / h` for
/// `c` and `s`.
pub fn squares(operator: Operator, geometry: &Geometry, factors: [f64; 2]) -> Vec<(usize, usize, f64)> {
    let density = geometry.density.value();
    match operator {
        Operator::HodgeLaplace => vec![(0, 0, factors[0] * density), (1, 1, factors[0] * density)],
        Operator::BiLaplace => {
            let values = factors[0] * density * density;
            vec![(0, 0, values), (1, 1, values), (2, 2, factors[1]), (3, 3, factors[1])]
        }
    }
}

/// `sum Q_kl b_k a_l` of all pairs of rows, added to a matrix by rows.
pub fn add(matrix: &mut [f64], rows: &[Features], q: &[(usize, usize, f64)], weight: f64) {
    let n = rows.len();
    for (i, a) in rows.iter().enumerate() {
        let mut image = [0.0; MOST];
        q.iter().for_each(|&(k, l, x)| image[l] += weight * x * a[k]);
        for (sum, b) in matrix[n * i..n * (i + 1)].iter_mut().zip(rows) {
            *sum += image.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        }
    }
}

/// The same against one row, added to a vector.
pub fn add_vector(
    vector: &mut [f64],
    rows: &[Features],
    q: &[(usize, usize, f64)],
    data: &Features,
    weight: f64,
) {
    let mut image = [0.0; MOST];
    q.iter().for_each(|&(k, l, x)| image[k] += weight * x * data[l]);
    for (sum, a) in vector.iter_mut().zip(rows) {
        *sum += image.iter().zip(a).map(|(x, y)| x * y).sum::<f64>();
    }
}
