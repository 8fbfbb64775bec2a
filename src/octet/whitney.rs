//! Whitney forms in a tetrahedron.

use nalgebra::{Matrix3, Vector3};

use super::complex::TET_EDGES;

type Vec3 = Vector3<f64>;

/// The lowest-order (Whitney) forms of a tetrahedron, with barycentric coordinates `l_i`:
///
/// ```text
/// 0-form   sum f_i l_i
/// 1-form   sum w_ij (l_i grad l_j - l_j grad l_i)
/// 2-form   2 sum F_ijk (l_i grad l_j x grad l_k + cyclic)  =  sum F_i (x - v_i) / (3 V)
/// 3-form   m / V
/// ```
///
/// `V` is the signed volume, `F_i` the flux out through the face opposite vertex `i`. In a tetrahedron of the control mesh these
/// are the limits of the linear schemes, for every `c`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WhitneyTet {
    vertices: [Vec3; 4],
    gradients: [Vec3; 4],
    volume: f64,
}

impl WhitneyTet {
    /// The forms of the tetrahedron with these vertices; `None` if it is flat.
    pub fn new(vertices: [Vec3; 4]) -> Option<Self> {
        let [a, b, c, d] = vertices;
        let columns = Matrix3::from_columns(&[b - a, c - a, d - a]);
        let volume = columns.determinant() / 6.0;
        // The rows of the inverse are the gradients of the barycentric coordinates.
        let inverse = columns.try_inverse().filter(|m| m.iter().all(|x| x.is_finite()))?;
        let [q, r, s] = [0, 1, 2].map(|i| inverse.row(i).transpose());
        Some(WhitneyTet { vertices, gradients: [-(q + r + s), q, r, s], volume })
    }

    /// The signed volume.
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// The barycentric coordinates of a point.
    pub fn barycentric(&self, x: Vec3) -> [f64; 4] {
        let [_, q, r, s] = self.gradients.map(|gradient| gradient.dot(&(x - self.vertices[0])));
        [1.0 - q - r - s, q, r, s]
    }

    /// The value of a 0-form with these values at the vertices.
    pub fn value(&self, values: [f64; 4], x: Vec3) -> f64 {
        self.barycentric(x).iter().zip(values).map(|(l, f)| l * f).sum()
    }

    /// The vector of a 1-form with these circulations along the edges, ordered as [`TET_EDGES`].
    pub fn vector(&self, circulations: [f64; 6], x: Vec3) -> Vec3 {
        let l = self.barycentric(x);
        let term = |([i, j], w): ([usize; 2], f64)| (self.gradients[j] * l[i] - self.gradients[i] * l[j]) * w;
        TET_EDGES.into_iter().zip(circulations).map(term).sum()
    }

    /// The flux vector of a 2-form with these fluxes through the faces, ordered and turned as
    /// [`TET_FACES`](super::TET_FACES).
    pub fn flux(&self, fluxes: [f64; 4], x: Vec3) -> Vec3 {
        let term = |(i, f): (usize, f64)| (x - self.vertices[i]) * f;
        fluxes.into_iter().enumerate().map(term).sum::<Vec3>() / (3.0 * self.volume)
    }

    /// The density of a 3-form with this integral.
    pub fn density(&self, integral: f64) -> f64 {
        integral / self.volume
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octet::TET_FACES;

    fn centroid(vertices: [Vec3; 4], face: usize) -> Vec3 {
        TET_FACES[face].iter().map(|&i| vertices[i]).sum::<Vec3>() / 3.0
    }

    fn tet() -> [Vec3; 4] {
        [[0.1, 0.0, 0.2], [1.0, 0.3, 0.1], [0.2, 1.1, -0.1], [0.3, 0.2, 0.9]].map(Vec3::from)
    }

    /// Constant and rotating vectors, and fluxes from a centre, are reproduced.
    #[test]
    fn simple_fields_are_reproduced() {
        let v = tet();
        let forms = WhitneyTet::new(v).unwrap();
        let (a, b, k) = (Vec3::new(1.0, -2.0, 0.5), Vec3::new(0.3, 0.7, -1.1), 0.8);
        let x = Vec3::new(0.4, 0.3, 0.2);
        // The integral of a + b x p along an edge is its value at the middle, the field being linear.
        let along = TET_EDGES.map(|[i, j]| (a + b.cross(&((v[i] + v[j]) / 2.0))).dot(&(v[j] - v[i])));
        assert!((forms.vector(along, x) - (a + b.cross(&x))).norm() < 1e-14);
        let through = [0, 1, 2, 3].map(|f| {
            let [p, q, r] = TET_FACES[f].map(|i| v[i]);
            (a + centroid(v, f) * k).dot(&(q - p).cross(&(r - p))) / 2.0
        });
        assert!((forms.flux(through, x) - (a + x * k)).norm() < 1e-14);
        let divergence: f64 = through.iter().sum();
        assert!((forms.density(divergence) - 3.0 * k).abs() < 1e-13);
        assert!((forms.value(v.map(|p| p.dot(&a)), x) - x.dot(&a)).abs() < 1e-14);
    }

    #[test]
    fn a_flat_tetrahedron_has_none() {
        let [a, b, c, _] = tet();
        assert!(WhitneyTet::new([a, b, c, (a + b + c) / 3.0]).is_none_or(|t| t.volume().abs() < 1e-16));
        assert!(WhitneyTet::new([a, b, c, c]).is_none());
    }
}
