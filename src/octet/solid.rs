//! Solids from grids in files, and back.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::complex::{Complex, ComplexError};
use super::field;
use super::lookup::Lookup;
use crate::cochain::Cochain;
use crate::io::volume::forms::SolidForms;
use crate::io::volume::{Array, Grid};

type Positions = Cochain<0, Vector3<f64>>;

/// Forms on one complex, at most one of each degree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolidFields {
    /// One value for each vertex.
    pub form0: Option<Cochain<0>>,
    /// One value for each edge.
    pub form1: Option<Cochain<1>>,
    /// One value for each triangle.
    pub form2: Option<Cochain<2>>,
    /// One value for each cell.
    pub form3: Option<Cochain<3>>,
}

impl SolidFields {
    /// The degrees that there are.
    pub fn degrees(&self) -> Vec<usize> {
        let there = [self.form0.is_some(), self.form1.is_some(), self.form2.is_some(), self.form3.is_some()];
        (0..4).filter(|&r| there[r]).collect()
    }
}

/// A complex in space, with what its file holds.
#[derive(Clone, Debug)]
pub struct Solid {
    /// Its cells, all positive.
    pub complex: Complex,
    /// Where its vertices are.
    pub positions: Positions,
    /// The forms that the file holds.
    pub forms: SolidForms,
    /// What was passed over or turned, one sentence each.
    pub notes: Vec<String>,
}

/// Why a grid is not a solid, or forms do not fit one. Numbers start at 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum SolidError {
    #[error(transparent)]
    Complex(#[from] ComplexError),
    #[error("holds no tetrahedra and no pyramids: give it cells that fill space")]
    NoCells,
    #[error("cell {cell} is flat: move its vertices or remove it")]
    Flat { cell: usize },
    #[error(
        "pyramid {pyramid} has no other on its base: pyramids are read in pairs, as octahedra; split it into tetrahedra"
    )]
    LonelyPyramid { pyramid: usize },
    #[error("{key}, entry {entry}: {vertices:?} is no {what} of the mesh: correct it")]
    NotThere { key: &'static str, entry: usize, vertices: Vec<u32>, what: &'static str },
    #[error("{key}, entry {entry}: the same {what} is listed twice: remove one")]
    Twice { key: &'static str, entry: usize, what: &'static str },
    #[error("{key}, entry {entry}: the value is not finite: correct it")]
    NotFinite { key: &'static str, entry: usize },
}

impl Solid {
    /// The tetrahedra of a grid, and an octahedron for each two pyramids on one base. Cells that are turned the wrong way
    /// round are turned. Line segments, triangles and cells with data named `form1`, `form2`, `form3` are forms, points
    /// with `form0` too.
    ///
    /// # Errors
    /// [`SolidError`] if the cells are not those of a solid.
    pub fn from_grid(grid: Grid) -> Result<Self, SolidError> {
        let (octs, of_pyramid) = octahedra(&grid.pyramids)?;
        let num_tets = grid.tets.len();
        if num_tets + octs.len() == 0 {
            return Err(SolidError::NoCells);
        }
        let mut forms = SolidForms::default();
        let named = |arrays: &[Array], name: &str| -> Option<Vec<f64>> {
            let array = arrays.iter().find(|array| array.name == name && array.components == 1);
            array.map(|array| array.values.clone())
        };
        if let Some(values) = named(&grid.point_data, "form0") {
            forms.vertices = Some((0..).zip(values).collect());
        }
        let cells = |name: &str, first: usize, count: usize| -> Option<Vec<f64>> {
            named(&grid.cell_data, name).map(|values| values[first..first + count].to_vec())
        };
        let (lines, triangles) = (grid.lines.len(), grid.triangles.len());
        if let Some(values) = cells("form1", 0, lines).filter(|values| !values.is_empty()) {
            forms.edges = Some(grid.lines.iter().zip(values).map(|(&[a, b], x)| (a, b, x)).collect());
        }
        if let Some(values) = cells("form2", lines, triangles).filter(|values| !values.is_empty()) {
            forms.triangles =
                Some(grid.triangles.iter().zip(values).map(|(&[a, b, c], x)| (a, b, c, x)).collect());
        }
        if let Some(values) = cells("form3", lines + triangles, num_tets + grid.pyramids.len()) {
            let mut integrals = values[..num_tets].to_vec();
            integrals.resize(num_tets + octs.len(), 0.0);
            for (oct, value) in of_pyramid.iter().zip(&values[num_tets..]) {
                integrals[num_tets + oct] += value;
            }
            forms.cells = Some((0..).zip(integrals).collect());
        }

        let mut complex = Complex::new(grid.points.len(), grid.tets, octs)?;
        let positions = Positions::new(grid.points);
        let (mut turned, mut notes) = (0, grid.notes);
        for (cell, volume) in field::volumes(&complex, &positions).into_iter().enumerate() {
            if volume == 0.0 {
                return Err(SolidError::Flat { cell });
            }
            if volume < 0.0 {
                turned += 1;
                match cell.checked_sub(num_tets) {
                    None => complex.tets[cell].swap(2, 3),
                    Some(o) => complex.octs[o].swap(0, 3),
                }
            }
        }
        if turned > 0 {
            notes.push(format!("{turned} cells with negative volume were turned round"));
            complex = Complex::new(complex.num_vertices, complex.tets, complex.octs)?;
        }
        Ok(Solid { complex, positions, forms, notes })
    }

    /// Forms by the numbers of this solid's cells.
    ///
    /// # Errors
    /// [`SolidError`] with the entry that does not fit.
    pub fn fields(&self, forms: &SolidForms) -> Result<SolidFields, SolidError> {
        let complex = &self.complex;
        let n = complex.num_cells(0);
        let mut fields = SolidFields::default();
        if let Some(list) = &forms.vertices {
            let cells = list.iter().map(|&(v, x)| ((v < n as u32).then_some((v, 1.0)), vec![v], x));
            fields.form0 = Some(Cochain::new(fill("vertices", "vertex", n, cells)?));
        }
        if let Some(list) = &forms.edges {
            let lookup = Lookup::new(n, complex.edges()).map_err(|_| SolidError::NoCells)?;
            let find = |v: [u32; 2]| {
                let e = if v.iter().all(|&v| v < n as u32) { lookup.find(v) } else { None };
                e.map(|e| (e, if complex.edges()[e as usize] == v { 1.0 } else { -1.0 }))
            };
            let cells = list.iter().map(|&(a, b, x)| (find([a, b]), vec![a, b], x));
            fields.form1 = Some(Cochain::new(fill("edges", "edge", complex.num_cells(1), cells)?));
        }
        if let Some(list) = &forms.triangles {
            let all: Vec<_> =
                (0..complex.num_cells(2) as u32).map(|t| complex.triangle_vertices(t)).collect();
            let lookup = Lookup::new(n, &all).map_err(|_| SolidError::NoCells)?;
            let find = |v: [u32; 3]| {
                let t = if v.iter().all(|&v| v < n as u32) { lookup.find(v) } else { None };
                let even = |t: u32| super::complex::is_even(all[t as usize], v);
                t.map(|t| (t, if even(t) { 1.0 } else { -1.0 }))
            };
            let cells = list.iter().map(|&(a, b, c, x)| (find([a, b, c]), vec![a, b, c], x));
            fields.form2 = Some(Cochain::new(fill("triangles", "triangle", complex.num_cells(2), cells)?));
        }
        if let Some(list) = &forms.cells {
            let count = complex.num_cells(3);
            let cells = list.iter().map(|&(i, x)| ((i < count as u32).then_some((i, 1.0)), vec![i], x));
            fields.form3 = Some(Cochain::new(fill("cells", "cell", count, cells)?));
        }
        Ok(fields)
    }
}

/// One value for each cell, from a list of cells with their signs.
fn fill(
    key: &'static str,
    what: &'static str,
    count: usize,
    cells: impl Iterator<Item = (Option<(u32, f64)>, Vec<u32>, f64)>,
) -> Result<Vec<f64>, SolidError> {
    let (mut values, mut listed) = (vec![0.0; count], vec![false; count]);
    for (entry, (cell, vertices, value)) in cells.enumerate() {
        let Some((cell, sign)) = cell else {
            return Err(SolidError::NotThere { key, entry, vertices, what });
        };
        if !value.is_finite() {
            return Err(SolidError::NotFinite { key, entry });
        }
        if std::mem::replace(&mut listed[cell as usize], true) {
            return Err(SolidError::Twice { key, entry, what });
        }
        values[cell as usize] = sign * value;
    }
    Ok(values)
}

/// The octahedra that pairs of pyramids on one base make, and for each pyramid its octahedron.
fn octahedra(pyramids: &[[u32; 5]]) -> Result<(Vec<[u32; 6]>, Vec<usize>), SolidError> {
    let mut on_base: BTreeMap<[u32; 4], usize> = BTreeMap::new();
    let (mut octs, mut of_pyramid) = (Vec::new(), vec![usize::MAX; pyramids.len()]);
    for (i, &[a, b, c, d, apex]) in pyramids.iter().enumerate() {
        let mut base = [a, b, c, d];
        base.sort_unstable();
        match on_base.remove(&base) {
            None => {
                on_base.insert(base, i);
            }
            Some(first) => {
                let [a, b, c, d, other] = pyramids[first];
                (of_pyramid[first], of_pyramid[i]) = (octs.len(), octs.len());
                octs.push([a, b, other, c, d, apex]);
            }
        }
    }
    match on_base.values().min() {
        Some(&pyramid) => Err(SolidError::LonelyPyramid { pyramid }),
        None => Ok((octs, of_pyramid)),
    }
}

/// A solid for a file: line segments with its 1-form, triangles with its 2-form, tetrahedra, and two pyramids for each
/// octahedron.
///
/// Point data: `form0`. Cell data: `form1` circulations on lines, `form2` fluxes on triangles, `form3` integrals over cells (a
/// pyramid has half of its octahedron's) and its `density`; and as vectors at the centroids of cells `form1Vector` and
/// `form2Vector`; `octahedron` is the number of a pyramid's octahedron, -1 elsewhere. NaN where there is no value.
/// Lines and triangles are written only if there is a form on them.
///
/// # Panics
/// If the positions or forms belong to another complex.
pub fn to_grid(complex: &Complex, positions: &Positions, fields: &SolidFields) -> Grid {
    let lines = if fields.form1.is_some() { complex.edges().to_vec() } else { Vec::new() };
    let triangles: Vec<_> = match fields.form2 {
        Some(_) => (0..complex.num_cells(2) as u32).map(|t| complex.triangle_vertices(t)).collect(),
        None => Vec::new(),
    };
    let pyramids: Vec<[u32; 5]> =
        complex.octs().iter().flat_map(|&[a, b, c, d, e, f]| [[a, b, d, e, c], [e, d, b, a, f]]).collect();
    let (sides, tets) = ([lines.len(), triangles.len()], complex.tets().len());
    // Data of cells: on lines, on triangles, and on tetrahedra and octahedra, these twice and divided by `share`.
    let spread = |name: &str, components: usize, on: [Option<&[f64]>; 3], share: f64| {
        let mut values = Vec::new();
        for (data, count) in on[..2].iter().zip(sides) {
            match data {
                Some(data) => values.extend_from_slice(data),
                None => values.resize(values.len() + components * count, f64::NAN),
            }
        }
        match on[2] {
            Some(data) => {
                let (of_tets, of_octs) = data.split_at(components * tets);
                values.extend_from_slice(of_tets);
                for entry in of_octs.chunks_exact(components) {
                    values.extend(entry.iter().chain(entry).map(|x| x / share));
                }
            }
            None => values.resize(values.len() + components * (tets + pyramids.len()), f64::NAN),
        }
        Array { name: name.to_owned(), components, values }
    };
    let flat =
        |vectors: Vec<Vector3<f64>>| -> Vec<f64> { vectors.iter().flat_map(|v| [v.x, v.y, v.z]).collect() };
    let mut cell_data = Vec::new();
    if let Some(form) = &fields.form1 {
        cell_data.push(spread("form1", 1, [Some(form.values()), None, None], 1.0));
        let vectors = flat(field::vectors(complex, positions, form));
        cell_data.push(spread("form1Vector", 3, [None, None, Some(&vectors)], 1.0));
    }
    if let Some(form) = &fields.form2 {
        cell_data.push(spread("form2", 1, [None, Some(form.values()), None], 1.0));
        let vectors = flat(field::fluxes(complex, positions, form));
        cell_data.push(spread("form2Vector", 3, [None, None, Some(&vectors)], 1.0));
    }
    if let Some(form) = &fields.form3 {
        cell_data.push(spread("form3", 1, [None, None, Some(form.values())], 2.0));
        let densities = field::densities(complex, positions, form);
        cell_data.push(spread("density", 1, [None, None, Some(&densities)], 1.0));
    }
    let octahedron: Vec<f64> =
        (0..complex.num_cells(3)).map(|cell| cell.checked_sub(tets).map_or(-1.0, |o| o as f64)).collect();
    cell_data.push(spread("octahedron", 1, [None, None, Some(&octahedron)], 1.0));
    let point_data = fields.form0.iter().map(|form| Array {
        name: "form0".to_owned(),
        components: 1,
        values: form.values().to_vec(),
    });
    Grid {
        points: positions.values().to_vec(),
        lines,
        triangles,
        tets: complex.tets().to_vec(),
        pyramids,
        point_data: point_data.collect(),
        cell_data,
        notes: Vec::new(),
    }
}
