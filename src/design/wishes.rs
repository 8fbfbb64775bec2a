//! Prescribed values as functionals of cochains.

use nalgebra::Vector3;

use super::DesignError;
use super::hodge::Hodge;
use super::product::Metric;
use super::spec::Spec;
use crate::limit::{Limit, SurfacePoint};
use crate::sparse::{Csr, row_of};
use crate::topology::{HalfEdge, SplitKind};

/// Prescribed values: a functional over edges, what it shall be, and how dearly.
pub(super) struct Wish {
    pub functional: Vec<f64>,
    pub value: f64,
    pub weight: Option<f64>,
}

impl Hodge<'_> {
    /// A point moved off the rim of its face by so little that it does not matter: densities do not exist at vertices.
    pub(super) fn off_rim(&self, point: SurfacePoint) -> SurfacePoint {
        const MARGIN: f64 = 1e-6;
        let inside = |x: f64| x.clamp(MARGIN, 1.0 - 3.0 * MARGIN);
        let (s, t) = (inside(point.s), inside(point.t));
        let slack = match self.surface().hierarchy().split_kind() {
            SplitKind::Triangle => (s + t - 1.0 + MARGIN).max(0.0) / 2.0,
            SplitKind::Quad => 0.0,
        };
        SurfacePoint { s: inside(s - slack), t: inside(t - slack), ..point }
    }

    /// The limit's value at a point as a combination of the cage's own coefficients.
    pub(super) fn functional(
        &self,
        degree: usize,
        point: &SurfacePoint,
    ) -> Result<Vec<(u32, [f64; 2])>, DesignError> {
        let mut weights = self.surface().functional(degree, point)?;
        let hierarchy = self.surface().hierarchy();
        for level in (1..=hierarchy.num_levels()).rev() {
            let operators = hierarchy.operators(level);
            let step: &Csr = [&operators.s0, &operators.s1, &operators.s2][degree];
            let mut above = vec![[0.0; 2]; step.cols()];
            for (cell, weight) in weights {
                let (columns, entries) = row_of(step, cell as usize);
                for (&j, &entry) in columns.iter().zip(entries) {
                    (0..2).for_each(|k| above[j as usize][k] += weight[k] * entry);
                }
            }
            let kept = above.into_iter().enumerate().filter(|(_, weight)| *weight != [0.0; 2]);
            weights = kept.map(|(cell, weight)| (cell as u32, weight)).collect();
        }
        Ok(weights)
    }

    pub(super) fn wishes(&self, spec: &Spec) -> Result<Vec<Wish>, DesignError> {
        let mesh = self.mesh();
        let mut wishes = Vec::new();
        let circulation = match self.metric() {
            Metric::Limit if !spec.edges.is_empty() => {
                Some(Limit::new(self.surface().hierarchy(), 0)?.operators(mesh).l1)
            }
            _ => None,
        };
        for (index, edge) in spec.edges.iter().enumerate() {
            check_number("edge value", index, edge.value)?;
            check_weight("weight of edge value", index, edge.weight)?;
            let [a, b] = edge.vertices;
            let h: HalfEdge = mesh.find_half_edge(a, b).ok_or(DesignError::NoEdge { vertices: [a, b] })?;
            let mut functional = vec![0.0; mesh.num_edges()];
            match &circulation {
                Some(l1) => {
                    let (columns, entries) = row_of(l1, h.edge() as usize);
                    let signed = columns.iter().zip(entries);
                    signed.for_each(|(&e, &x)| functional[e as usize] = h.sign() * x);
                }
                None => functional[h.edge() as usize] = h.sign(),
            }
            wishes.push(Wish { functional, value: edge.value, weight: edge.weight });
        }
        if !spec.vectors.is_empty() {
            self.wish_vectors(spec, &mut wishes)?;
        }
        Ok(wishes)
    }

    /// Two wishes for each vector: its products with the tangents.
    fn wish_vectors(&self, spec: &Spec, wishes: &mut Vec<Wish>) -> Result<(), DesignError> {
        for (index, wanted) in spec.vectors.iter().enumerate() {
            let bad = wanted.vector.iter().find(|x| !x.is_finite());
            bad.map_or(Ok(()), |&value| check_number("vector", index, value))?;
            check_weight("weight of vector", index, wanted.weight)?;
            let components = self.functional(1, &wanted.point)?;
            let tangents = self.tangents(&wanted.point)?;
            // Orthonormal directions, so that a weight holds all directions alike.
            let (t1, t2) = (tangents[0], tangents[1]);
            let face = wanted.point.face;
            let first = t1.try_normalize(1e-300).ok_or(DesignError::NoTangent { face })?;
            let across = t2 - first * first.dot(&t2);
            if across.norm() <= 1e-7 * t2.norm() || !across.norm().is_finite() {
                return Err(DesignError::NoTangent { face });
            }
            let second = across.normalize();
            let along = wanted.vector - first.cross(&second) * first.cross(&second).dot(&wanted.vector);
            if wanted.vector.norm() > 0.0 && along.norm() <= 1e-9 * wanted.vector.norm() {
                return Err(DesignError::NoTangent { face });
            }
            let (l1, l2, slant) = (t1.norm(), across.norm(), t2.dot(&first));
            // omega(first) = omega_s / l1;  omega(second) = (omega_t - slant omega(first)) / l2
            for (k, direction) in [first, second].into_iter().enumerate() {
                let mut functional = vec![0.0; self.mesh().num_edges()];
                for &(edge, [s, t]) in &components {
                    functional[edge as usize] += if k == 0 { s / l1 } else { (t - slant * s / l1) / l2 };
                }
                wishes.push(Wish { functional, value: direction.dot(&wanted.vector), weight: wanted.weight });
            }
        }
        Ok(())
    }

    fn tangents(&self, point: &SurfacePoint) -> Result<[Vector3<f64>; 2], DesignError> {
        let jets = self.surface().evaluate_0(self.positions(), &[*point])?;
        Ok(jets[0].derivatives)
    }
}

pub(super) fn check_number(what: &'static str, index: usize, value: f64) -> Result<(), DesignError> {
    if value.is_finite() { Ok(()) } else { Err(DesignError::BadNumber { what, index, value }) }
}

pub(super) fn check_weight(what: &'static str, index: usize, weight: Option<f64>) -> Result<(), DesignError> {
    match weight {
        Some(value) if !(value > 0.0 && value.is_finite()) => {
            Err(DesignError::BadNumber { what, index, value })
        }
        _ => Ok(()),
    }
}
