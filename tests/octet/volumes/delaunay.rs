//! Bowyer and Watson's algorithm, for a few hundred points in general position.

use std::collections::BTreeMap;

use formwork::nalgebra::{Matrix3, Vector3};

/// The Delaunay tetrahedra, positively oriented.
pub fn tetrahedra(points: &[Vector3<f64>]) -> Vec<[u32; 4]> {
    let n = points.len();
    let mut all = points.to_vec();
    let far = [[-1., -1., -1.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    all.extend(far.map(|p| Vector3::from(p) * 1e3));
    let mut tets = vec![[n, n + 1, n + 2, n + 3]];
    let holds = |tet: &[usize; 4], p: Vector3<f64>| {
        let [a, b, c, d] = tet.map(|v| all[v]);
        let m = Matrix3::from_rows(&[(b - a).transpose(), (c - a).transpose(), (d - a).transpose()]);
        let right =
            Vector3::new((b - a).norm_squared(), (c - a).norm_squared(), (d - a).norm_squared()) / 2.0;
        let centre = m.lu().solve(&right).expect("points in general position");
        (p - a - centre).norm_squared() < centre.norm_squared()
    };
    for (i, &p) in points.iter().enumerate() {
        let (hit, kept): (Vec<_>, Vec<_>) = tets.into_iter().partition(|tet| holds(tet, p));
        tets = kept;
        let mut faces: BTreeMap<[usize; 3], usize> = BTreeMap::new();
        for [a, b, c, d] in hit {
            for mut face in [[b, c, d], [a, c, d], [a, b, d], [a, b, c]] {
                face.sort_unstable();
                *faces.entry(face).or_default() += 1;
            }
        }
        tets.extend(faces.into_iter().filter(|(_, count)| *count == 1).map(|([a, b, c], _)| [a, b, c, i]));
    }
    let inner = tets.into_iter().filter(|tet| tet.iter().all(|&v| v < n));
    let turned = inner.map(|[a, b, c, d]| {
        let [p, q, r, s] = [a, b, c, d].map(|v| points[v]);
        let positive = (q - p).cross(&(r - p)).dot(&(s - p)) > 0.0;
        (if positive { [a, b, c, d] } else { [b, a, c, d] }).map(|v| v as u32)
    });
    turned.collect()
}
