//! Matrices and vectors as PETSc binary files, for solvers of large systems.
//!
//! A file holds objects one after the other, everything big-endian:
//!
//! | object | i32 | then |
//! |---|---|---|
//! | matrix | 1211216, rows, columns, entries | the number of entries of each row, the column of each entry (i32), the entries (f64) |
//! | vector | 1211214, length | the entries (f64) |
//!
//! In Python `PETSc.Mat().load(viewer)` and `PETSc.Vec().load(viewer)` read them in turn, in C `MatLoad` and `VecLoad`, with
//! a PETSc of 32-bit indices. Source: the manual page of `MatLoad`.

use std::io::{self, Write};
use std::path::Path;

use super::{IoError, atomic};
use crate::sparse::{Csr, row_of};

/// What a file holds.
#[derive(Clone, Copy, Debug)]
pub enum Object<'a> {
    /// A sparse matrix.
    Matrix(&'a Csr),
    /// A vector.
    Vector(&'a [f64]),
}

const MATRIX: i32 = 1_211_216;
const VECTOR: i32 = 1_211_214;

/// Writes objects to one file, in their order.
///
/// # Errors
/// [`IoError::Write`]; also if a matrix has more entries than 32-bit indices count.
pub fn write(path: &Path, objects: &[Object]) -> Result<(), IoError> {
    atomic::write(path, |out| objects.iter().try_for_each(|object| write_to(out, object)))
}

fn write_to(out: &mut impl Write, object: &Object) -> io::Result<()> {
    let count = |n: usize| {
        i32::try_from(n).map_err(|_| io::Error::other("more entries than PETSc counts in 32 bits"))
    };
    match object {
        Object::Matrix(matrix) => {
            let head = [MATRIX, count(matrix.rows())?, count(matrix.cols())?, count(matrix.nnz())?];
            ints(out, head)?;
            ints(out, (0..matrix.rows()).map(|i| row_of(matrix, i).0.len() as i32))?;
            ints(out, matrix.indices().iter().map(|&j| j as i32))?;
            floats(out, matrix.data())
        }
        Object::Vector(values) => {
            ints(out, [VECTOR, count(values.len())?])?;
            floats(out, values)
        }
    }
}

fn ints(out: &mut impl Write, values: impl IntoIterator<Item = i32>) -> io::Result<()> {
    values.into_iter().try_for_each(|x| out.write_all(&x.to_be_bytes()))
}

fn floats(out: &mut impl Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|x| out.write_all(&x.to_be_bytes()))
}
