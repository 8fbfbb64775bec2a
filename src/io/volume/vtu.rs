//! VTK's unstructured grids, `.vtu`: text, base64 or raw, plain or compressed with zlib, by the crate `vtkio`.

use std::path::Path;
use std::thread;

use nalgebra::Vector3;
use vtkio::model::{
    Attribute, Attributes, ByteOrder, CellType, Cells, DataArray, DataSet, ElementType, IOBuffer, Piece,
    UnstructuredGridPiece, Version, VertexNumbers, Vtk,
};

use super::{Array, Grid};
use crate::io::usd::READER_THREAD;
use crate::io::{IoError, atomic};

/// The kinds of cells that a [`Grid`] has, in its order.
const KINDS: [CellType; 4] = [CellType::Line, CellType::Triangle, CellType::Tetra, CellType::Pyramid];
const SIZES: [usize; 4] = [2, 3, 4, 5];

/// Reads a grid; `name` is used in messages.
///
/// # Errors
/// [`IoError::Content`] with the array that is wrong.
pub fn parse(name: &str, bytes: Vec<u8>) -> Result<Grid, IoError> {
    // The crate trusts some counts in the file and panics on others: on a thread of its own that is an error.
    let read = move || Vtk::parse_xml(&bytes[..]).and_then(load_pieces);
    let reader = thread::Builder::new().name(READER_THREAD.to_owned()).spawn(read);
    let damaged = |reason: &str| {
        let reason: String =
            reason.split_whitespace().collect::<Vec<_>>().join(" ").chars().take(160).collect();
        let problem =
            format!("the VTK reader refuses it ({reason}): write it again, uncompressed or with zlib");
        IoError::content(name, "file", problem)
    };
    let reader = reader.map_err(|error| damaged(&error.to_string()))?;
    let pieces = match reader.join() {
        Ok(Ok(pieces)) => pieces,
        Ok(Err(error)) => return Err(damaged(&error.to_string())),
        Err(_) => return Err(damaged("it gives up")),
    };
    let fail = |(place, problem): (String, String)| IoError::content(name, &place, problem);
    let mut grid = Grid::default();
    match <[UnstructuredGridPiece; 1]>::try_from(pieces) {
        Ok([piece]) => add_piece(&mut grid, piece).map_err(fail)?,
        Err(pieces) => {
            let problem = format!("has {} pieces: merge them into one grid", pieces.len());
            return Err(IoError::content(name, "file", problem));
        }
    }
    Ok(grid)
}

fn load_pieces(vtk: Vtk) -> Result<Vec<UnstructuredGridPiece>, vtkio::Error> {
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else { return Ok(Vec::new()) };
    pieces.into_iter().map(|piece| piece.into_loaded_piece_data(None).map_err(vtkio::Error::from)).collect()
}

type Problem = (String, String);

fn problem(place: &str, problem: impl Into<String>) -> Problem {
    (place.to_owned(), problem.into())
}

fn add_piece(grid: &mut Grid, piece: UnstructuredGridPiece) -> Result<(), Problem> {
    let coordinates: Vec<f64> = piece
        .points
        .cast_into()
        .ok_or_else(|| problem("Points", "are not numbers: write them as Float64"))?;
    if !coordinates.len().is_multiple_of(3) {
        return Err(problem("Points", "are not triples: give each point three coordinates"));
    }
    grid.points = coordinates.chunks_exact(3).map(|p| Vector3::new(p[0], p[1], p[2])).collect();
    if let Some(i) = grid.points.iter().position(|p| !p.iter().all(|x| x.is_finite())) {
        return Err(problem(
            &format!("point {i}"),
            "is not finite: correct its coordinates (numbers start at 0)",
        ));
    }
    let VertexNumbers::XML { connectivity, offsets } = piece.cells.cell_verts else {
        return Err(problem("Cells", "are not listed as connectivity and offsets"));
    };
    // The number of each cell in the file, kind by kind.
    let mut order: [Vec<usize>; 4] = Default::default();
    let (mut start, mut others) = (0usize, 0);
    if offsets.len() != piece.cells.types.len() {
        let counts = format!("{} offsets and {} types", offsets.len(), piece.cells.types.len());
        return Err(problem("Cells", format!("have {counts}: give each cell one of both")));
    }
    for (i, (&end, kind)) in offsets.iter().zip(&piece.cells.types).enumerate() {
        let place = || format!("cell {i} (numbers start at 0)");
        let range = usize::try_from(end).ok().and_then(|end| connectivity.get(start..end));
        let vertices =
            range.ok_or_else(|| problem(&place(), "ends outside the connectivity: correct offsets"))?;
        start = end as usize;
        let Some(k) = KINDS.iter().position(|known| known == kind) else {
            match kind {
                CellType::Vertex | CellType::PolyVertex | CellType::PolyLine => others += 1,
                _ => {
                    let advice =
                        "only tetrahedra, pyramids, triangles and lines are read: split it into tetrahedra";
                    return Err(problem(&place(), format!("is a {kind:?}: {advice}")));
                }
            }
            continue;
        };
        if vertices.len() != SIZES[k] {
            return Err(problem(&place(), format!("has {} vertices for {}", vertices.len(), SIZES[k])));
        }
        let in_range = |&v: &u64| if v < grid.points.len() as u64 { Some(v as u32) } else { None };
        let v: Option<Vec<u32>> = vertices.iter().map(in_range).collect();
        let advice = || format!("names a point beyond the {} there are", grid.points.len());
        let v = v.ok_or_else(|| problem(&place(), advice()))?;
        order[k].push(i);
        match k {
            0 => grid.lines.push([v[0], v[1]]),
            1 => grid.triangles.push([v[0], v[1], v[2]]),
            2 => grid.tets.push([v[0], v[1], v[2], v[3]]),
            _ => grid.pyramids.push([v[0], v[1], v[2], v[3], v[4]]),
        }
    }
    if others > 0 {
        grid.notes.push(format!("{others} cells that are points or chains of lines were passed over"));
    }
    let points: Vec<usize> = (0..grid.points.len()).collect();
    grid.point_data = arrays(piece.data.point, points.len(), &points)?;
    grid.cell_data = arrays(piece.data.cell, piece.cells.types.len(), &order.concat())?;
    Ok(())
}

/// Arrays of numbers with an entry for each of `order`, which are numbers of the file's `count`.
fn arrays(attributes: Vec<Attribute>, count: usize, order: &[usize]) -> Result<Vec<Array>, Problem> {
    let mut arrays = Vec::new();
    for attribute in attributes {
        let Attribute::DataArray(array) = attribute else { continue };
        let components = array.elem.num_comp() as usize;
        let Some(values) = array.data.cast_into::<f64>() else { continue };
        if values.len() != components * count {
            let sizes = format!("has {} numbers, not {components} for each of {count}", values.len());
            return Err(problem(&format!("array `{}`", array.name), sizes));
        }
        let values =
            order.iter().flat_map(|&i| &values[components * i..components * (i + 1)]).copied().collect();
        arrays.push(Array { name: array.name, components, values });
    }
    Ok(arrays)
}

/// Writes a grid, its numbers in binary.
///
/// # Errors
/// [`IoError::Write`]; `path` is then as it was before.
pub fn write(path: &Path, grid: Grid) -> Result<(), IoError> {
    let counts = [grid.lines.len(), grid.triangles.len(), grid.tets.len(), grid.pyramids.len()];
    let mut types = Vec::with_capacity(grid.num_cells());
    let mut offsets = Vec::with_capacity(grid.num_cells());
    let mut end = 0;
    for ((count, kind), size) in counts.into_iter().zip(KINDS).zip(SIZES) {
        for _ in 0..count {
            end += size as u64;
            offsets.push(end);
            types.push(kind);
        }
    }
    let lines = grid.lines.iter().flatten();
    let all = lines.chain(grid.triangles.iter().flatten()).chain(grid.tets.iter().flatten());
    let connectivity = all.chain(grid.pyramids.iter().flatten()).map(|&v| u64::from(v)).collect();
    let points: Vec<f64> = grid.points.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    let attribute = |array: Array| {
        let elem = ElementType::Scalars { num_comp: array.components as u32, lookup_table: None };
        Attribute::DataArray(DataArray { name: array.name, elem, data: IOBuffer::F64(array.values) })
    };
    let piece = UnstructuredGridPiece {
        points: IOBuffer::F64(points),
        cells: Cells { cell_verts: VertexNumbers::XML { connectivity, offsets }, types },
        data: Attributes {
            point: grid.point_data.into_iter().map(attribute).collect(),
            cell: grid.cell_data.into_iter().map(attribute).collect(),
        },
    };
    let vtk = Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data: DataSet::UnstructuredGrid { meta: None, pieces: vec![Piece::Inline(Box::new(piece))] },
        file_path: None,
    };
    atomic::write(path, |out| vtk.write_xml(out).map_err(|error| std::io::Error::other(error.to_string())))
}
