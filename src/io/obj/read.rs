use std::fs;
use std::io::{BufRead, Cursor, Read};
use std::path::Path;

use nalgebra::Vector3;

use super::ObjProblem;
use super::filter::{Filtered, filter};
use crate::cochain::Cochain;
use crate::io::{Asset, IoError};
use crate::topology::Element;

/// Reads a control cage from a file.
///
/// The cage is not yet checked: [`Asset::cage`] does that.
///
/// # Errors
/// [`IoError::Read`], or as for [`parse`].
pub fn read(path: &Path) -> Result<Asset, IoError> {
    let bytes = fs::read(path).map_err(IoError::read(path))?;
    parse(&path.display().to_string(), &bytes)
}

/// Reads a control cage from the contents of a file; `name` is used in messages.
///
/// # Errors
/// [`IoError::Obj`] with the line that is wrong: a coordinate or an index that is no number, an index out
/// of range, coordinates that are not finite, malformed tags.
pub fn parse(name: &str, bytes: &[u8]) -> Result<Asset, IoError> {
    let fail = |(line, problem)| IoError::Obj { file: name.to_owned(), line, problem };
    let filtered = filter(bytes).map_err(fail)?;
    let loaded = match load(&filtered) {
        Ok(loaded) => loaded,
        Err(reason) => {
            return Err(match diagnose(&filtered) {
                Some(problem) => fail(problem),
                None => IoError::ObjRefused { file: name.to_owned(), reason },
            });
        }
    };
    let Filtered { mut descriptor, source, notes, .. } = filtered;
    for (vertex, position) in loaded.positions.iter().enumerate() {
        if let Some(&value) = position.iter().find(|x| !x.is_finite()) {
            let line = source.line(Element::Vertex(vertex as u32)).unwrap_or_default();
            return Err(fail((line, ObjProblem::NotFinite { vertex, value })));
        }
    }
    descriptor.num_vertices = loaded.positions.len();
    descriptor.face_sizes = loaded.face_sizes;
    descriptor.face_vertices = loaded.face_vertices;
    let positions = Cochain::new(loaded.positions);
    Ok(Asset { name: name.to_owned(), descriptor, positions, source, notes, ..Default::default() })
}

#[derive(Default)]
struct Loaded {
    positions: Vec<Vector3<f64>>,
    face_sizes: Vec<u32>,
    face_vertices: Vec<u32>,
}

/// Has tobj parse the numbers.
///
/// It numbers vertices by first use and drops the rest, so a face that names all of them in order goes
/// before the others: its numbers are then those of the file. That face is taken off again.
fn load(filtered: &Filtered) -> Result<Loaded, String> {
    let (num_vertices, num_faces) = (filtered.source.vertices.len(), filtered.source.faces.len());
    if num_vertices == 0 && num_faces == 0 {
        return Ok(Loaded::default());
    }
    let mut all_vertices = String::from("f");
    for index in 1..=num_vertices {
        all_vertices.push(' ');
        all_vertices.push_str(&index.to_string());
    }
    all_vertices.push('\n');
    let mut stream = Cursor::new(all_vertices).chain(Cursor::new(&filtered.stream));
    let mesh = parse_with_tobj(&mut stream)?;

    let positions: Vec<_> = mesh.positions.chunks_exact(3).map(Vector3::from_column_slice).collect();
    let face_sizes = match mesh.face_arities.is_empty() {
        true => vec![3; num_faces],
        false => mesh.face_arities.get(1..).unwrap_or_default().to_vec(),
    };
    let face_vertices = mesh.indices.get(num_vertices..).unwrap_or_default().to_vec();
    let in_order = mesh.indices.iter().take(num_vertices).copied().eq(0..num_vertices as u32);
    let sizes: usize = face_sizes.iter().map(|&n| n as usize).sum();
    if positions.len() != num_vertices
        || face_sizes.len() != num_faces
        || sizes != face_vertices.len()
        || !in_order
    {
        return Err("its vertices came back in another order".to_owned());
    }
    Ok(Loaded { positions, face_sizes, face_vertices })
}

fn parse_with_tobj(stream: &mut impl BufRead) -> Result<tobj::Mesh, String> {
    let options = tobj::LoadOptions::default();
    let (models, _) = tobj::load_obj_buf(stream, &options, |_| Ok(Default::default()))
        .map_err(|error| error.to_string())?;
    match <[tobj::Model; 1]>::try_from(models) {
        Ok([model]) => Ok(model.mesh),
        Err(models) => Err(format!("{} objects where one was expected", models.len())),
    }
}

/// Finds the line that tobj stopped at, which it does not say: the first that breaks one of its rules.
fn diagnose(filtered: &Filtered) -> Option<(usize, ObjProblem)> {
    let count = filtered.source.vertices.len();
    let (mut vertex, mut face) = (0, 0);
    for text in filtered.stream.lines() {
        let mut words = text.split_whitespace();
        let (problem, line) = if words.next() == Some("v") {
            vertex += 1;
            (check_position(words, vertex - 1), filtered.source.vertices[vertex - 1])
        } else {
            face += 1;
            (
                words.find_map(|token| check_index(token, face - 1, vertex, count)),
                filtered.source.faces[face - 1],
            )
        };
        if let Some(problem) = problem {
            return Some((line as usize, problem));
        }
    }
    None
}

fn check_position<'a>(words: impl Iterator<Item = &'a str> + Clone, vertex: usize) -> Option<ObjProblem> {
    let mut tokens = words.clone();
    if let Some(token) = tokens.find(|token| token.parse::<f64>().is_err()) {
        return Some(ObjProblem::NotANumber { vertex, token: token.to_owned() });
    }
    let count = words.count();
    (count < 3).then_some(ObjProblem::TooFewCoordinates { vertex, count })
}

/// `before` vertices come before this face in the file, which has `count` in all.
fn check_index(token: &str, face: usize, before: usize, count: usize) -> Option<ObjProblem> {
    let digits = token.strip_prefix(['-', '+']).unwrap_or(token);
    if digits.is_empty() || !digits.bytes().all(|b| b.is_ascii_digit()) {
        return Some(ObjProblem::NotAnIndex { face, token: token.to_owned() });
    }
    let index = token.to_owned();
    // A number too long to parse is out of range all the same.
    let magnitude = digits.parse().unwrap_or(usize::MAX);
    match (magnitude, token.starts_with('-')) {
        (0, _) => Some(ObjProblem::IndexZero { face }),
        (m, false) if m > count => Some(ObjProblem::IndexOutOfRange { face, index, count }),
        (m, true) if m > before => Some(ObjProblem::IndexBeforeStart { face, index, count: before }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::{BoundaryInterpolation, Corner, Crease, CreasingMethod, TriangleSubdivision};

    fn parsed(text: &str) -> Asset {
        parse("a.obj", text.as_bytes()).unwrap()
    }

    fn refused(text: &str) -> String {
        parse("a.obj", text.as_bytes()).unwrap_err().to_string()
    }

    const POINTS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 9 9 9\nv 0 0 1\n";

    #[test]
    fn file_indices_survive_everything_that_tobj_renumbers() {
        // Groups, a vertex of no face, texture coordinates that differ, first use in another order,
        // relative and forward indices, continued lines.
        let text = format!(
            "g a\nf 4/1/1 3/2/1 2/3/1\n{POINTS}vt 0 0\ng b\nusemtl m\nf -1//2 -4/7 \\\n-6\nf 6 4 3 \\\n 1\no c\nf 7 4 3\nv 5 5 5"
        );
        for text in [text.clone(), text.replace('\n', "\r\n")] {
            let asset = parsed(&text);
            assert_eq!(asset.descriptor.num_vertices, 7);
            assert_eq!(asset.descriptor.face_sizes, [3, 3, 4, 3]);
            assert_eq!(asset.descriptor.face_vertices, [3, 2, 1, 5, 2, 0, 5, 3, 2, 0, 6, 3, 2]);
            assert_eq!(asset.positions[4], Vector3::new(9.0, 9.0, 9.0));
            assert_eq!(asset.positions[6], Vector3::new(5.0, 5.0, 5.0));
            assert_eq!(asset.source.line(Element::Face(2)), Some(14));
        }
    }

    #[test]
    fn the_face_of_all_vertices_is_recognised_at_every_size() {
        // tobj leaves the sizes out if all faces are triangles, and has faces of one and two vertices.
        for n in 0..6usize {
            for faces in ["", "f 1 1 1\n", "f 1 1 1\nf 1 1 1 1\n", "f 1\n", "f 1 1\n", "f\n"] {
                if n == 0 && faces.contains('1') {
                    continue;
                }
                let asset = parsed(&("v 1 2 3\n".repeat(n) + faces));
                let sizes: Vec<u32> = faces.lines().map(|f| f.split(' ').count() as u32 - 1).collect();
                assert_eq!((asset.positions.len(), asset.descriptor.face_sizes), (n, sizes), "{n} {faces:?}");
            }
        }
    }

    #[test]
    fn coordinates_are_read_to_the_last_bit() {
        let values = [0.1, -1.0 / 3.0, 1e-300, 5e-324, 123456789.12345679, f64::MAX];
        for x in values {
            assert_eq!(parsed(&format!("v {x} 0 {x:e}\n")).positions[0], Vector3::new(x, 0.0, x));
        }
    }

    #[test]
    fn every_bad_number_has_its_line() {
        for (line, message) in [
            ("v 1 2", "a.obj: line 7: vertex 6 has 2 coordinates: write x, y and z"),
            ("v 1,5 2 3", "a.obj: line 7: vertex 6 has the coordinate `1,5`: write a decimal"),
            ("v 1 nan 3", "a.obj: line 7: vertex 6 has the coordinate NaN: coordinates must be finite"),
            ("v 1 2 -1e999", "a.obj: line 7: vertex 6 has the coordinate -inf"),
            ("f 1 2 0", "a.obj: line 7: face 0 refers to vertex 0: OBJ counts vertices from 1"),
            ("f 1 2 7", "a.obj: line 7: face 0 refers to vertex 7, but the file has 6 (counted from 1)"),
            ("f 1 2 -7", "a.obj: line 7: face 0 refers to vertex -7 (counted back), but only 6 come"),
            ("f 1 2 1000000000", "a.obj: line 7: face 0 refers to vertex 1000000000, but"),
            ("f 1 2 99999999999999999999", "a.obj: line 7: face 0 refers to vertex 99999999999999999999,"),
            ("f 1 2 -99999999999999999999", "a.obj: line 7: face 0 refers to vertex -9999999999999999"),
            ("f 1 2 -9223372036854775808", "a.obj: line 7: face 0 refers to vertex -92233720368547758"),
            ("f 1 2 //3", "a.obj: line 7: face 0 refers to `//3`, which is not a vertex index"),
            ("f 1 2 3.0", "a.obj: line 7: face 0 refers to `3.0`, which is not a vertex index"),
            ("f 1, 2, 3", "a.obj: line 7: face 0 refers to `1,`, which is not"),
        ] {
            let error = refused(&format!("{POINTS}{line}\nf 1 2 3\n"));
            assert!(error.starts_with(message), "{line}: {error}");
        }
    }

    #[test]
    fn tags_are_read() {
        let asset = parsed(
            "t crease 4/1/0 0 1 1 2 2.5\nt crease 4/2/0 2 3 3 0 1 10\nt corner 2/2/0 0 1 3 4\n\
             t hole 2/0/0 5 6\nt interpolateboundary 1/0/0 1\nt creasemethod 0/0/1 chaikin\n\
             t smoothtriangles 0/0/1 smooth\n",
        );
        let crease = |a, b, sharpness| Crease { vertices: [a, b], sharpness };
        let d = &asset.descriptor;
        assert_eq!(d.creases, [crease(0, 1, 2.5), crease(1, 2, 2.5), crease(2, 3, 1.0), crease(3, 0, 10.0)]);
        assert_eq!(d.corners, [(0, 3.0), (1, 4.0)].map(|(vertex, sharpness)| Corner { vertex, sharpness }));
        assert_eq!(d.holes, [5, 6]);
        assert_eq!(d.boundary, BoundaryInterpolation::EdgeAndCorner);
        assert_eq!((d.creasing, d.triangles), (CreasingMethod::Chaikin, TriangleSubdivision::Smooth));
        assert_eq!(asset.source.line(Element::Crease(2)), Some(2));
        assert_eq!(asset.source.line(Element::Corner(1)), Some(3));
        assert_eq!(asset.source.line(Element::Hole(1)), Some(4));
        assert_eq!(parsed("").descriptor.boundary, BoundaryInterpolation::EdgeOnly);
    }

    #[test]
    fn every_bad_tag_has_its_line() {
        for (line, message) in [
            ("t", "the tag has no name"),
            ("t crease", "tag `crease` has the counts ``"),
            ("t crease 2/1 0 1 2", "tag `crease` has the counts `2/1`"),
            ("t crease 2/1/0 0 1", "tag `crease` promises 3 values and has 2"),
            ("t hole 4000000000/4000000000/0 1", "tag `hole` promises 8000000000 values and has 1"),
            ("t crease 2/1/0 0 x 2", "tag `crease` has the value `x` where an index from 0 belongs"),
            ("t crease 2/1/0 0 -1 2", "tag `crease` has the value `-1` where an index from 0 belongs"),
            ("t crease 3/1/0 0 1 2 2", "tag `crease` has 3 integers, 1 numbers and 0 words: it takes pairs"),
            ("t crease 2/0/0 0 1", "tag `crease` has 2 integers, 0 numbers"),
            ("t crease 4/3/0 0 1 1 2 1 1 1", "tag `crease` has 4 integers, 3 numbers"),
            ("t crease 2/1/0 0 1 sharp", "tag `crease` has the value `sharp` where a number belongs"),
            ("t corner 1/0/0 0", "tag `corner` says 0: it takes vertices with one sharpness"),
            ("t hole 0/0/0", "tag `hole` has no values: it takes faces"),
            ("t interpolateboundary 1/0/0 3", "tag `interpolateboundary` says 3: it takes one integer: 0"),
            ("t creasemethod 0/0/1 soft", "tag `creasemethod` says `soft`: it takes one word: normal or"),
            ("t smoothtriangles 1/0/0 1", "tag `smoothtriangles` says 1: it takes one word: catmark or"),
        ] {
            let error = refused(&format!("# tags\n{line}\n"));
            assert!(error.starts_with(&format!("a.obj: line 2: {message}")), "{line}: {error}");
        }
    }
}
