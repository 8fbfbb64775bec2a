use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;

use super::homology::Homology;
use super::product::{InnerProduct, Metric};
use super::{Condition, DesignError};
use crate::cochain::Cochain;
use crate::limit::LimitSurface;
use crate::sparse::{Cholesky, Csr, apply, assemble, combination, inner, row_of};
use crate::topology::Mesh;

const FIXED: u32 = u32::MAX;

/// The Hodge decomposition of the 1-cochains of a cage in one inner product, with one factorised Laplacian for all that
/// is asked of it.
///
/// Where the inner product is singular (triangle meshes, see [`crate::fem`]), cochains whose limit is 0 count as coexact;
/// everything else is as it would be without them.
pub struct Hodge<'a> {
    surface: &'a LimitSurface,
    /// On the surface's finest level.
    positions: Cochain<0, Vector3<f64>>,
    metric: Metric,
    product: InnerProduct,
    homology: Homology,
    /// For each vertex its unknown.
    unknown: Vec<u32>,
    laplacian: Cholesky,
    /// One for each generator, with coefficient 1 there and 0 at the others.
    harmonic: Vec<Vec<f64>>,
    /// The same made orthonormal, and the coefficients that make them so: `orthonormal = harmonic * to_orthonormal`.
    orthonormal: Vec<Vec<f64>>,
    /// `M1` times these.
    images: Vec<Vec<f64>>,
    to_orthonormal: DMatrix<f64>,
}

/// A 1-cochain in three parts, which sum to it.
#[derive(Clone, Debug)]
pub struct Decomposition {
    /// `a`, 0 at one vertex of each component, or on its normal loops.
    pub potential: Cochain<0>,
    /// `d0 a`: no curl, orthogonal to the others.
    pub exact: Cochain<1>,
    /// What has curl but no divergence: orthogonal to every exact and every harmonic cochain.
    pub coexact: Cochain<1>,
    /// The stream function `y` of the coexact part, tested with each face's 2-form: `M1 k = d1' y` at every edge but those
    /// of normal loops, that is, `k = delta b` weakly with `y = M2 b`. 0 at one face of each component that has no
    /// tangential loop, and beyond these.
    pub stream: Cochain<2>,
    /// No curl, no divergence.
    pub harmonic: Cochain<1>,
    /// The circulation of the harmonic part round the cycle of each generator.
    pub circulations: Vec<f64>,
}

impl<'a> Hodge<'a> {
    /// Prepares the decomposition on the cage of a surface. `conditions` are those of the boundary loops, see
    /// [`Homology::new`].
    ///
    /// # Errors
    /// If the surface is not a manifold along an edge, there are fewer loops than conditions, or the surface is
    /// degenerate.
    ///
    /// # Panics
    /// If the positions do not belong to the cage.
    pub fn new(
        surface: &'a LimitSurface,
        positions: &Cochain<0, Vector3<f64>>,
        metric: Metric,
        conditions: &[Condition],
    ) -> Result<Self, DesignError> {
        let homology = Homology::new(surface.hierarchy().level(0).mesh(), conditions)?;
        let product = InnerProduct::new(metric, surface, positions)?;
        Self::with_product(surface, positions, metric, product, homology)
    }

    /// [`Hodge::new`] with parts that are there already: what follows is the factorisation and one solution for each
    /// generator.
    ///
    /// # Errors
    /// If the inner product is degenerate.
    pub fn with_product(
        surface: &'a LimitSurface,
        positions: &Cochain<0, Vector3<f64>>,
        metric: Metric,
        product: InnerProduct,
        homology: Homology,
    ) -> Result<Self, DesignError> {
        let mesh = surface.hierarchy().level(0).mesh();
        let mut unknown = vec![0; mesh.num_vertices()];
        let mut pinned = vec![false; homology.num_components()];
        let mut count = 0;
        for v in 0..mesh.num_vertices() as u32 {
            let pin = homology
                .balancing_component(v)
                .is_some_and(|component| !std::mem::replace(&mut pinned[component], true));
            unknown[v as usize] = match pin || homology.is_fixed_vertex(v) {
                true => FIXED,
                false => {
                    count += 1;
                    count - 1
                }
            };
        }
        let matrix = laplacian(mesh, &product.mass, &unknown, count as usize);
        let laplacian = Cholesky::definite(&matrix).map_err(|_| {
            let diagonal = |i: usize| {
                let (columns, entries) = row_of(&matrix, i);
                columns.iter().position(|&j| j as usize == i).map_or(0.0, |at| entries[at])
            };
            let bad = (0..matrix.rows()).find(|&i| diagonal(i) <= 0.0 || diagonal(i).is_nan()).unwrap_or(0);
            let vertex = unknown.iter().position(|&u| u as usize == bad).unwrap_or(0) as u32;
            DesignError::Singular { vertex }
        })?;
        let mut hodge = Hodge {
            surface,
            positions: surface.refine(positions),
            metric,
            product,
            homology,
            unknown,
            laplacian,
            harmonic: Vec::new(),
            orthonormal: Vec::new(),
            images: Vec::new(),
            to_orthonormal: DMatrix::zeros(0, 0),
        };
        hodge.find_harmonic()?;
        Ok(hodge)
    }

    fn find_harmonic(&mut self) -> Result<(), DesignError> {
        let mesh = self.mesh();
        let n = self.homology.generators().len();
        let no_curl = vec![0.0; mesh.num_faces()];
        for i in 0..n {
            let unit: Vec<f64> = (0..n).map(|j| f64::from(u8::from(i == j))).collect();
            let mut form = self.homology.with_curl(mesh, &no_curl, &unit);
            self.remove_exact(&mut form);
            self.harmonic.push(form);
        }
        // h' M1 h = L L', and h L'^-1 is orthonormal; twice, for rounding.
        self.orthonormal = self.harmonic.clone();
        self.to_orthonormal = DMatrix::identity(n, n);
        for _ in 0..2 {
            let images: Vec<Vec<f64>> =
                self.orthonormal.iter().map(|h| apply(&self.product.mass, h)).collect();
            let gram = DMatrix::from_fn(n, n, |i, j| {
                let (i, j) = (i.max(j), i.min(j));
                inner(&self.orthonormal[i], &images[j])
            });
            let lower = gram.cholesky().ok_or(DesignError::Singular { vertex: 0 })?.l();
            let change = lower.transpose().try_inverse().ok_or(DesignError::Singular { vertex: 0 })?;
            self.orthonormal = (0..n)
                .map(|j| combination(&self.orthonormal, change.column(j).as_slice(), mesh.num_edges()))
                .collect();
            self.to_orthonormal = &self.to_orthonormal * change;
        }
        self.images = self.orthonormal.iter().map(|h| apply(&self.product.mass, h)).collect();
        Ok(())
    }

    /// The cage.
    pub fn mesh(&self) -> &'a Mesh {
        self.surface.hierarchy().level(0).mesh()
    }

    /// The surface.
    pub fn surface(&self) -> &'a LimitSurface {
        self.surface
    }

    /// The positions, on the surface's finest level.
    pub fn positions(&self) -> &Cochain<0, Vector3<f64>> {
        &self.positions
    }

    /// Where lengths are measured.
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// The inner product.
    pub fn product(&self) -> &InnerProduct {
        &self.product
    }

    /// Loops, generators and cycles.
    pub fn homology(&self) -> &Homology {
        &self.homology
    }

    /// The harmonic forms, one for each generator: circulation 1 round its cycle and 0 round the others.
    pub fn harmonic_basis(&self) -> &[Vec<f64>] {
        &self.harmonic
    }

    /// An orthonormal basis of the harmonic forms.
    pub(super) fn orthonormal_basis(&self) -> &[Vec<f64>] {
        &self.orthonormal
    }

    /// The number of entries of the factorised Laplacian.
    pub fn factor_entries(&self) -> usize {
        self.laplacian.entries()
    }

    /// `M1 c`.
    ///
    /// # Panics
    /// If the cochain is not one of the cage.
    pub fn mass(&self, c: &Cochain<1>) -> Cochain<1> {
        Cochain::new(apply(&self.product.mass, c.values()))
    }

    /// `d0' M1 c`: minus the divergence of the field, tested with each vertex's function. Normal loops included.
    ///
    /// # Panics
    /// If the cochain is not one of the cage.
    pub fn weak_codifferential(&self, c: &Cochain<1>) -> Cochain<0> {
        Cochain::new(transposed_d0(self.mesh(), &apply(&self.product.mass, c.values())))
    }

    /// The potential `a` with `d0' M1 d0 a = right`, where it is free.
    pub(super) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let size = self.unknown.iter().filter(|&&u| u != FIXED).count();
        let mut x = vec![0.0; size];
        for (&u, &value) in self.unknown.iter().zip(right) {
            if u != FIXED {
                x[u as usize] = value;
            }
        }
        let x = self.laplacian.solve(x);
        self.unknown.iter().map(|&u| if u == FIXED { 0.0 } else { x[u as usize] }).collect()
    }

    /// Takes the exact part off a cochain and returns its potential. Twice, so that what is left of the factor's rounding
    /// is gone.
    pub(super) fn remove_exact(&self, c: &mut [f64]) -> Vec<f64> {
        let mut potential = vec![0.0; self.mesh().num_vertices()];
        for _ in 0..2 {
            let right = transposed_d0(self.mesh(), &apply(&self.product.mass, c));
            let more = self.solve(&right);
            c.par_iter_mut().zip(self.mesh().edges()).for_each(|(x, &[a, b])| {
                *x -= more[b as usize] - more[a as usize];
            });
            potential.iter_mut().zip(&more).for_each(|(x, y)| *x += y);
        }
        potential
    }

    /// Takes the harmonic part off a cochain and returns its coefficients on the orthonormal basis.
    pub(super) fn remove_harmonic(&self, c: &mut [f64], times: usize) -> DVector<f64> {
        let n = self.orthonormal.len();
        let mut coefficients = DVector::zeros(n);
        for _ in 0..times.min(times * n) {
            let found = DVector::from_fn(n, |i, _| inner(&self.images[i], c));
            let part = combination(&self.orthonormal, found.as_slice(), c.len());
            c.iter_mut().zip(part).for_each(|(x, y)| *x -= y);
            coefficients += found;
        }
        coefficients
    }

    /// The harmonic cochain with these circulations round the cycles of the generators.
    ///
    /// # Panics
    /// If there is not one for each generator.
    pub fn harmonic(&self, circulations: &[f64]) -> Cochain<1> {
        assert_eq!(circulations.len(), self.harmonic.len(), "coefficients of another surface");
        Cochain::new(combination(&self.harmonic, circulations, self.mesh().num_edges()))
    }

    /// The parts of a cochain.
    ///
    /// # Panics
    /// If the cochain is not one of the cage.
    pub fn decompose(&self, cochain: &Cochain<1>) -> Decomposition {
        assert_eq!(cochain.len(), self.mesh().num_edges(), "a 1-cochain of another mesh");
        let mut rest = cochain.values().to_vec();
        let potential: Cochain<0> = Cochain::new(self.remove_exact(&mut rest));
        let coefficients = self.remove_harmonic(&mut rest, 2);
        let harmonic = combination(&self.orthonormal, coefficients.as_slice(), rest.len());
        let circulations = &self.to_orthonormal * coefficients;
        // With W `Homology::with_curl`, d1 W y = y wherever curl balances, so y = W' d1' y.
        let stream = self.homology.of_curl(self.mesh(), &apply(&self.product.mass, &rest));
        Decomposition {
            exact: potential.exterior_derivative(self.mesh()),
            potential,
            coexact: Cochain::new(rest),
            stream: Cochain::new(stream),
            harmonic: Cochain::new(harmonic),
            circulations: circulations.as_slice().to_vec(),
        }
    }
}

/// `d0' M1 d0` over the unknowns.
fn laplacian(mesh: &Mesh, mass: &Csr, unknown: &[u32], size: usize) -> Csr {
    let mut vertex = vec![0; size];
    for (v, &u) in unknown.iter().enumerate().filter(|(_, u)| **u != FIXED) {
        vertex[u as usize] = v as u32;
    }
    assemble((size, size), |i, row| {
        for &h in mesh.vertex_half_edges(vertex[i]) {
            // The vertex is the tail of h: d0 has -1 there along h.
            let (columns, entries) = row_of(mass, h.edge() as usize);
            for (&e, &entry) in columns.iter().zip(entries) {
                let [a, b] = mesh.edges()[e as usize];
                for (end, sign) in [(a, h.sign()), (b, -h.sign())] {
                    if unknown[end as usize] != FIXED {
                        row.add(unknown[end as usize], sign * entry);
                    }
                }
            }
        }
    })
}

/// `d0' y`.
pub(super) fn transposed_d0(mesh: &Mesh, y: &[f64]) -> Vec<f64> {
    let at = |v: u32| -mesh.vertex_half_edges(v).iter().map(|h| h.sign() * y[h.edge() as usize]).sum::<f64>();
    (0..mesh.num_vertices() as u32).into_par_iter().map(at).collect()
}
