//! Gmsh's `.msh` files, versions 2.2 and 4.1, text and binary.
//!
//! The reader is our own: the crate there is (`mshio`) knows version 4.1 only and drops the numbers of nodes that
//! are dense but out of order, which moves vertices without a word.

use std::collections::HashMap;

use nalgebra::Vector3;

use super::Grid;
use crate::io::IoError;
use crate::io::error::quote;

/// Reads the first-order tetrahedra, pyramids, triangles and lines of a file; `name` is used in messages. Points are
/// numbered in the order of the file.
///
/// # Errors
/// [`IoError::Content`] with the line (text) or byte (binary) that is wrong.
pub fn parse(name: &str, bytes: Vec<u8>) -> Result<Grid, IoError> {
    let mut reader = Reader { bytes: &bytes, at: 0, binary: false, swapped: false, wide: false };
    reader.grid().map_err(|problem| IoError::content(name, &reader.place(), problem))
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
    binary: bool,
    /// Whether binary numbers are big-endian.
    swapped: bool,
    /// Whether counts and numbers of nodes take 8 bytes, as they do from version 4 on.
    wide: bool,
}

type Result_<T> = Result<T, String>;

impl Reader<'_> {
    fn place(&self) -> String {
        let before = &self.bytes[..self.at.min(self.bytes.len())];
        match self.binary {
            true => format!("byte {}", self.at),
            false => format!("line {}", 1 + before.iter().filter(|&&b| b == b'\n').count()),
        }
    }

    /// The next word of the text.
    fn word(&mut self) -> Result_<&str> {
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace());
        let start = start.ok_or("the file ends too early: it was cut off, write it again")?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len() - start);
        self.at += start + length;
        std::str::from_utf8(&rest[start..start + length]).map_err(|_| "is no text: write it again".to_owned())
    }

    fn number<T: std::str::FromStr>(&mut self) -> Result_<T> {
        let word = self.word()?;
        word.parse()
            .map_err(|_| format!("{} is not the number that belongs here: write the file again", quote(word)))
    }

    fn raw<const N: usize>(&mut self) -> Result_<[u8; N]> {
        let found = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>());
        let mut raw = *found.ok_or("the file ends too early: it was cut off, write it again")?;
        self.at += N;
        if self.swapped {
            raw.reverse();
        }
        Ok(raw)
    }

    fn int(&mut self) -> Result_<i64> {
        if self.binary { Ok(i64::from(i32::from_le_bytes(self.raw()?))) } else { self.number() }
    }

    /// A count or the number of a node or an element.
    fn size(&mut self) -> Result_<u64> {
        match (self.binary, self.wide) {
            (true, true) => Ok(u64::from_le_bytes(self.raw()?)),
            (true, false) => Ok(u64::from(u32::from_le_bytes(self.raw()?))),
            (false, _) => self.number(),
        }
    }

    /// A count of things that take at least `least` bytes each: one that the file cannot hold is refused.
    fn count(&mut self, least: usize) -> Result_<usize> {
        let count = self.size()?;
        let left = (self.bytes.len() - self.at.min(self.bytes.len())) / least;
        match usize::try_from(count).ok().filter(|&count| count <= left) {
            Some(count) => Ok(count),
            None => Err(format!("{count} things are announced and the file ends before: it was cut off")),
        }
    }

    fn float(&mut self) -> Result_<f64> {
        let x = if self.binary { f64::from_le_bytes(self.raw()?) } else { self.number()? };
        if x.is_finite() { Ok(x) } else { Err("a coordinate is not finite: correct it".to_owned()) }
    }

    /// Skips to what follows the line that is being read.
    fn end_line(&mut self) {
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        self.at += rest.iter().position(|&b| b == b'\n').map_or(rest.len(), |i| i + 1);
    }

    fn expect(&mut self, word: &str) -> Result_<()> {
        let found = self.word()?.to_owned();
        if found == word { Ok(()) } else { Err(format!("{} stands where {word} belongs", quote(&found))) }
    }

    fn grid(&mut self) -> Result_<Grid> {
        if self.word().ok() != Some("$MeshFormat") {
            return Err("is no Gmsh file: it does not start with $MeshFormat".to_owned());
        }
        let version = self.word()?.to_owned();
        let (binary, size): (u8, u8) = (self.number()?, self.number()?);
        self.wide = match (version.as_str(), size) {
            ("4.1", 8) => true,
            ("2.2" | "2.1" | "2", 8) => false,
            _ => {
                return Err(format!(
                    "has version {} and numbers of {size} bytes: write it as version 4.1 or 2.2 with 8",
                    quote(&version)
                ));
            }
        };
        if binary == 1 {
            self.end_line();
            self.binary = true;
            let one = self.raw::<4>()?;
            self.swapped = one == 1i32.to_be_bytes();
            if !self.swapped && one != 1i32.to_le_bytes() {
                return Err("the mark of the byte order is damaged: write the file again".to_owned());
            }
        }
        self.expect("$EndMeshFormat")?;
        let (mut grid, mut numbers, mut has_elements) = (Grid::default(), HashMap::new(), false);
        while self.bytes[self.at.min(self.bytes.len())..].iter().any(|b| !b.is_ascii_whitespace()) {
            let section = self.word()?.to_owned();
            self.end_line();
            match section.as_str() {
                "$Nodes" => {
                    self.nodes(&mut grid, &mut numbers)?;
                    self.expect("$EndNodes")?;
                }
                "$Elements" => {
                    has_elements = true;
                    self.elements(&mut grid, &numbers)?;
                    self.expect("$EndElements")?;
                }
                _ => self.skip(&section)?,
            }
        }
        if has_elements { Ok(grid) } else { Err("has no $Elements: write it with them".to_owned()) }
    }

    fn skip(&mut self, section: &str) -> Result_<()> {
        let Some(name) = section.strip_prefix('$') else {
            return Err(format!("{} stands where a section belongs", quote(section)));
        };
        let end = format!("$End{name}");
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        let found = rest.windows(end.len()).position(|window| window == end.as_bytes());
        self.at +=
            found.ok_or_else(|| format!("{} has no end: the file was cut off", quote(section)))? + end.len();
        Ok(())
    }

    fn nodes(&mut self, grid: &mut Grid, numbers: &mut HashMap<u64, u32>) -> Result_<()> {
        let mut add = |grid: &mut Grid, number: u64, p: [f64; 3]| {
            grid.points.push(Vector3::from(p));
            match numbers.insert(number, grid.points.len() as u32 - 1) {
                None => Ok(()),
                Some(_) => Err(format!("node {number} is there twice: number the nodes again")),
            }
        };
        if !self.wide {
            // Counts are text in version 2, also in binary files.
            let count: usize = self.number()?;
            self.end_line();
            for _ in 0..count {
                let number = self.size()?;
                let p = [self.float()?, self.float()?, self.float()?];
                add(grid, number, p)?;
            }
            return Ok(());
        }
        let blocks = self.count(4)?;
        let _ = (self.size()?, self.size()?, self.size()?);
        for _ in 0..blocks {
            let (dimension, _, parametric) = (self.int()?, self.int()?, self.int()?);
            let count = self.count(4)?;
            let block: Vec<u64> = (0..count).map(|_| self.size()).collect::<Result_<_>>()?;
            for number in block {
                let p = [self.float()?, self.float()?, self.float()?];
                let parameters = if parametric == 0 { 0 } else { dimension };
                for _ in 0..parameters {
                    self.float()?;
                }
                add(grid, number, p)?;
            }
        }
        Ok(())
    }

    fn elements(&mut self, grid: &mut Grid, numbers: &HashMap<u64, u32>) -> Result_<()> {
        if self.wide {
            let blocks = self.count(4)?;
            let _ = (self.size()?, self.size()?, self.size()?);
            for _ in 0..blocks {
                let (_, _, kind) = (self.int()?, self.int()?, self.int()?);
                let nodes = num_nodes(kind)?;
                for _ in 0..self.count(4)? {
                    let number = self.size()?;
                    self.element(grid, numbers, kind, nodes, number)?;
                }
            }
            return Ok(());
        }
        let count: usize = self.number()?;
        self.end_line();
        let mut done = 0;
        while done < count {
            if !self.binary {
                let (number, kind, tags) = (self.size()?, self.int()?, self.int()?);
                for _ in 0..tags {
                    self.int()?;
                }
                self.element(grid, numbers, kind, num_nodes(kind)?, number)?;
                done += 1;
                continue;
            }
            let (kind, block, tags) = (self.int()?, self.int()?, self.int()?);
            let nodes = num_nodes(kind)?;
            if block < 1 {
                return Err("a block of elements is empty: write the file again".to_owned());
            }
            for _ in 0..block {
                let number = self.size()?;
                for _ in 0..tags {
                    self.int()?;
                }
                self.element(grid, numbers, kind, nodes, number)?;
            }
            done += block as usize;
        }
        Ok(())
    }

    fn element(
        &mut self,
        grid: &mut Grid,
        numbers: &HashMap<u64, u32>,
        kind: i64,
        nodes: usize,
        number: u64,
    ) -> Result_<()> {
        let mut v = [0; 5];
        for slot in &mut v[..nodes] {
            let node = self.size()?;
            *slot = *numbers
                .get(&node)
                .ok_or_else(|| format!("element {number} names node {node}, which is not there"))?;
        }
        match kind {
            1 => grid.lines.push([v[0], v[1]]),
            2 => grid.triangles.push([v[0], v[1], v[2]]),
            4 => grid.tets.push([v[0], v[1], v[2], v[3]]),
            7 => grid.pyramids.push(v),
            _ => {} // a point
        }
        Ok(())
    }
}

/// The nodes of an element of a kind that is read.
fn num_nodes(kind: i64) -> Result_<usize> {
    match kind {
        15 => Ok(1),
        1 => Ok(2),
        2 => Ok(3),
        4 => Ok(4),
        7 => Ok(5),
        3 | 5 | 6 => Err("has quads, hexahedra or prisms: mesh it with tetrahedra".to_owned()),
        8..=14 | 16.. => Err("has elements of higher order: mesh it with order 1".to_owned()),
        _ => Err(format!("has elements of the kind {kind}, which Gmsh does not list: write the file again")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 0\n$EndEntities\n$Nodes\n2 4 1 4\n\
        3 1 0 2\n4\n2\n0 0 1\n1 0 0\n2 5 0 2\n1\n3\n0 0 0\n0 1 0\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n\
        1 1 2 3 4\n$EndElements\n";

    /// Blocks out of order, which is where the crate errs.
    #[test]
    fn nodes_are_found_by_their_numbers() {
        let grid = parse("a.msh", SMALL.into()).unwrap();
        let [a, b, c, d] = grid.tets[0].map(|v| <[f64; 3]>::from(grid.points[v as usize]));
        assert_eq!([a, b, c, d], [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]]);
    }

    #[test]
    fn damage_is_named() {
        let message = |text: &str| parse("a.msh", text.into()).unwrap_err().to_string();
        for (from, to, words) in [
            ("4.1 0 8", "3.0 0 8", "write it as version 4.1 or 2.2"),
            ("1 1 2 3 4\n", "1 1 2 3 9\n", "line 23: element 1 names node 9, which is not there"),
            ("3 1 4 1", "3 1 5 1", "mesh it with tetrahedra"),
            ("3 1 4 1", "3 1 11 1", "mesh it with order 1"),
            ("3 1 4 1", "3 1 4 77777777", "announced"),
            ("0 0 1\n", "0 nan 1\n", "not finite"),
            ("0 0 1\n", "0 zero 1\n", "line 12: `zero` is not the number"),
            ("$Elements", "$Elefants", "no end"),
        ] {
            let text = SMALL.replacen(from, to, 1);
            assert!(message(&text).contains(words), "{words}: {}", message(&text));
        }
        assert!(message("solid").contains("is no Gmsh file"));
        for end in 0..SMALL.len() - 1 {
            if let Ok(grid) = parse("a.msh", SMALL.as_bytes()[..end].to_vec()) {
                assert_eq!(grid.tets.len(), 1, "cut at {end}");
            }
        }
    }
}
