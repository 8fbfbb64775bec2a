//! Complexes of cochains with inner products.

use super::{Elements, FemError};
use crate::sparse::{Csr, assemble, row_of};
use crate::topology::Mesh;

/// Cochains of degree 0, 1 and 2 with their exterior derivatives and inner products: a Hilbert complex of finite
/// dimension, as in Arnold, Falk, Winther, "Finite element exterior calculus: from Hodge theory to numerical stability",
/// 2010. All that [`HodgeLaplace`](super::HodgeLaplace) needs to know of a surface.
///
/// The whole complex has natural boundary conditions; [`HilbertComplex::restricted`] makes others, and domains.
#[derive(Clone, Debug)]
pub struct HilbertComplex {
    mass: [Csr; 3],
    d: [Csr; 2],
    /// For each degree the cells whose coefficients are kept at 0, ascending.
    pinned: [Vec<u32>; 3],
}

impl Elements<'_> {
    /// The complex of the limit forms whose coefficients are on a level of the surface's hierarchy: each lies in the
    /// next. All are on the same surface, in the same metric.
    ///
    /// Its basis may be dependent ([`Elements::dependent`]): [`HilbertComplex::pinned`] sees to that.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn complex(&self, level: usize) -> HilbertComplex {
        let mesh = self.surface().hierarchy().level(level).mesh();
        let mass = [0, 1, 2].map(|k| self.mass_on(level, k, |_| 1.0));
        HilbertComplex::new(mass, [mesh.d0(), mesh.d1()])
    }
}

/// The cells of a mesh that are not on its boundary, for [`HilbertComplex::restricted`]: functions that vanish on the
/// boundary, 1-forms that vanish along it, and all 2-forms.
pub fn interior(mesh: &Mesh) -> [Vec<bool>; 3] {
    let edges: Vec<bool> = (0..mesh.num_edges() as u32).map(|e| !mesh.is_boundary_edge(e)).collect();
    let mut vertices = vec![true; mesh.num_vertices()];
    for (&[a, b], _) in mesh.edges().iter().zip(&edges).filter(|(_, inside)| !**inside) {
        (vertices[a as usize], vertices[b as usize]) = (false, false);
    }
    [vertices, edges, vec![true; mesh.num_faces()]]
}

impl HilbertComplex {
    /// The complex of the masses `M0`, `M1`, `M2` and the derivatives `d0`, `d1`.
    ///
    /// # Panics
    /// If the matrices do not fit.
    pub fn new(mass: [Csr; 3], d: [Csr; 2]) -> Self {
        for (k, mass) in mass.iter().enumerate() {
            assert_eq!(mass.rows(), mass.cols(), "M{k} is not square");
        }
        for k in 0..2 {
            assert_eq!(d[k].shape(), (mass[k + 1].rows(), mass[k].rows()), "d{k} does not fit the masses");
        }
        HilbertComplex { mass, d, pinned: Default::default() }
    }

    /// The mass of the forms of a degree.
    ///
    /// # Panics
    /// If `degree > 2`.
    pub fn mass(&self, degree: usize) -> &Csr {
        &self.mass[degree]
    }

    /// The derivative of the forms of a degree, 0 or 1.
    ///
    /// # Panics
    /// If `degree > 1`.
    pub fn d(&self, degree: usize) -> &Csr {
        &self.d[degree]
    }

    /// The complex with the coefficients of some cells kept at 0, where the basis is dependent: one for each relation,
    /// from a cell that takes part in it. The forms stay all that they were.
    ///
    /// # Panics
    /// If there is no such degree or cell.
    pub fn pinned(mut self, degree: usize, cells: &[u32]) -> Self {
        assert!(cells.iter().all(|&cell| (cell as usize) < self.len(degree)), "a cell of another complex");
        self.pinned[degree].extend(cells);
        self.pinned[degree].sort_unstable();
        self
    }

    /// Whether a coefficient is kept at 0.
    pub(super) fn is_pinned(&self, degree: usize, cell: u32) -> bool {
        self.pinned[degree].binary_search(&cell).is_ok()
    }

    /// The number of unknowns of a degree.
    ///
    /// # Panics
    /// If `degree > 2`.
    pub fn len(&self, degree: usize) -> usize {
        self.mass[degree].rows()
    }

    /// Whether there are no unknowns of a degree.
    ///
    /// # Panics
    /// If `degree > 2`.
    pub fn is_empty(&self, degree: usize) -> bool {
        self.len(degree) == 0
    }

    /// The area of the domain: `<1, 1>`, so far as the constant is there.
    pub fn area(&self) -> f64 {
        self.mass[0].data().iter().sum()
    }

    /// The complex of the cochains that are 0 on all cells but those that are kept, in their order.
    ///
    /// It is a complex in two cases. Cells may be left out together with all cells on their boundary: this is the
    /// essential condition, trace 0. And cells may be left out whose forms vanish on a domain
    /// ([`HilbertComplex::support`]).
    ///
    /// # Panics
    /// If there is not one flag for each cell.
    pub fn restricted(&self, keep: &[Vec<bool>; 3]) -> Self {
        let new: [Vec<u32>; 3] = [0, 1, 2].map(|k| {
            assert_eq!(keep[k].len(), self.len(k), "flags of another complex");
            let mut count = 0;
            let number = |&kept: &bool| {
                count += u32::from(kept);
                if kept { count - 1 } else { u32::MAX }
            };
            keep[k].iter().map(number).collect()
        });
        let block = |matrix: &Csr, rows: &[u32], columns: &[u32]| {
            let old: Vec<usize> = (0..rows.len()).filter(|&i| rows[i] != u32::MAX).collect();
            let width = columns.iter().filter(|&&j| j != u32::MAX).count();
            assemble((old.len(), width), |i, row| {
                let (indices, entries) = row_of(matrix, old[i]);
                for (&j, &entry) in indices.iter().zip(entries) {
                    if columns[j as usize] != u32::MAX {
                        row.add(columns[j as usize], entry);
                    }
                }
            })
        };
        HilbertComplex {
            mass: [0, 1, 2].map(|k| block(&self.mass[k], &new[k], &new[k])),
            d: [0, 1].map(|k| block(&self.d[k], &new[k + 1], &new[k])),
            pinned: [0, 1, 2].map(|k| {
                let kept = self.pinned[k].iter().map(|&cell| new[k][cell as usize]);
                kept.filter(|&cell| cell != u32::MAX).collect()
            }),
        }
    }

    /// The cells whose forms do not vanish everywhere: those with an entry on the diagonal of their mass.
    pub fn support(&self) -> [Vec<bool>; 3] {
        let seen = |mass: &Csr| (0..mass.rows()).map(|i| diagonal(mass, i) > 0.0).collect();
        [0, 1, 2].map(|k| seen(&self.mass[k]))
    }

    /// The Betti numbers: the dimensions of the harmonic 0-, 1- and 2-forms. Counted from `d0` and `d1` alone, as
    /// components of vertices and of faces, and by Euler's formula.
    ///
    /// # Errors
    /// [`FemError::NonManifold`] if an edge has more than two faces.
    pub fn betti(&self) -> Result<[usize; 3], FemError> {
        let b0 = kernel(&self.d[0])?.0;
        let b2 = kernel(&super::transpose(&self.d[1]))?.0;
        let [v, e, f] = [0, 1, 2].map(|k| self.len(k));
        Ok([b0, (b0 + b2 + e).saturating_sub(v + f), b2])
    }
}

impl HilbertComplex {
    /// For each vertex the component on which functions may be constant, if there is one: essential conditions take it
    /// away.
    pub(super) fn constants(&self) -> Result<(usize, Vec<Option<u32>>), FemError> {
        let (count, of) = kernel(&self.d[0])?;
        Ok((count, of.into_iter().map(|x| x.map(|(component, _)| component)).collect()))
    }
}

/// The entry on the diagonal of a row.
pub(super) fn diagonal(matrix: &Csr, i: usize) -> f64 {
    let (columns, entries) = row_of(matrix, i);
    columns.binary_search(&(i as u32)).map_or(0.0, |at| entries[at])
}

/// The kernel of a matrix with at most two entries, 1 or -1, in a row: its columns fall into components, on each of which
/// it is 1 or -1, unless a row with one entry, or a round trip that changes the sign, makes it 0. Its dimension, and
/// for each column the component and the sign.
#[allow(clippy::type_complexity)]
fn kernel(d: &Csr) -> Result<(usize, Vec<Option<(u32, f64)>>), FemError> {
    let n = d.cols();
    // To a parent, with the sign that leads there.
    let mut parent: Vec<(u32, f64)> = (0..n as u32).map(|i| (i, 1.0)).collect();
    let mut zero = vec![false; n];
    fn root(parent: &mut [(u32, f64)], start: u32) -> (u32, f64) {
        let (mut at, mut sign) = (start, 1.0);
        while parent[at as usize].0 != at {
            let (up, s) = parent[at as usize];
            // Halve the path.
            let (over, t) = parent[up as usize];
            parent[at as usize] = (over, s * t);
            (at, sign) = (over, sign * s * t);
        }
        (at, sign)
    }
    for e in 0..d.rows() {
        let (cells, signs) = row_of(d, e);
        match *cells {
            [] => {}
            [a] => {
                let (a, _) = root(&mut parent, a);
                zero[a as usize] = true;
            }
            [a, b] => {
                // signs[0] x_a + signs[1] x_b = 0
                let ((ra, sa), (rb, sb)) = (root(&mut parent, a), root(&mut parent, b));
                let relation = -signs[0] * signs[1] * sa * sb;
                if ra != rb {
                    parent[rb as usize] = (ra, relation);
                    zero[ra as usize] |= zero[rb as usize];
                } else if relation < 0.0 {
                    zero[ra as usize] = true;
                }
            }
            _ => return Err(FemError::NonManifold { edge: e as u32, faces: cells.len() }),
        }
    }
    let mut count = 0;
    let number: Vec<Option<u32>> = (0..n)
        .map(|i| {
            let counts = parent[i].0 == i as u32 && !zero[i];
            count += u32::from(counts);
            counts.then(|| count - 1)
        })
        .collect();
    let of = (0..n as u32).map(|i| {
        let (root, sign) = root(&mut parent, i);
        number[root as usize].map(|component| (component, sign))
    });
    let of = of.collect();
    Ok((count as usize, of))
}
