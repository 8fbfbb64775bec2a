use std::str::{FromStr, SplitWhitespace};

use super::ObjProblem;
use crate::io::SourceLines;
use crate::topology::{
    BoundaryInterpolation, Corner, Crease, CreasingMethod, Descriptor, TriangleSubdivision,
};

const TAGS: [&str; 6] =
    ["crease", "corner", "hole", "interpolateboundary", "creasemethod", "smoothtriangles"];

/// The values of a tag line, `t NAME ni/nf/ns` followed by `ni` integers, `nf` numbers and `ns` words.
struct Tag<'a> {
    name: &'static str,
    integers: Vec<u32>,
    numbers: Vec<f32>,
    words: Vec<&'a str>,
}

/// Reads the rest of a `t` line into `descriptor`. Returns the name of a tag that is not known.
pub(super) fn read<'a>(
    mut words: SplitWhitespace<'a>,
    line: u32,
    descriptor: &mut Descriptor,
    source: &mut SourceLines,
) -> Result<Option<&'a str>, ObjProblem> {
    let name = words.next().ok_or(ObjProblem::TagWithoutName)?;
    let Some(&name) = TAGS.iter().find(|&&tag| tag == name) else {
        return Ok(Some(name));
    };
    let tag = Tag::parse(name, words)?;
    match name {
        "crease" => tag.creases(line, descriptor, source)?,
        "corner" => tag.corners(line, descriptor, source)?,
        "hole" => tag.holes(line, descriptor, source)?,
        "interpolateboundary" => descriptor.boundary = tag.boundary()?,
        "creasemethod" => {
            descriptor.creasing =
                tag.word([("normal", CreasingMethod::Uniform), ("chaikin", CreasingMethod::Chaikin)])?;
        }
        _ => {
            descriptor.triangles = tag
                .word([("catmark", TriangleSubdivision::Catmark), ("smooth", TriangleSubdivision::Smooth)])?;
        }
    }
    Ok(None)
}

impl<'a> Tag<'a> {
    fn parse(name: &'static str, mut words: SplitWhitespace<'a>) -> Result<Self, ObjProblem> {
        let counts = words.next().unwrap_or_default();
        let parsed: Option<Vec<u32>> = counts.split('/').map(|n| n.parse().ok()).collect();
        let Some(&[ni, nf, ns]) = parsed.as_deref() else {
            return Err(ObjProblem::TagCounts { tag: name, counts: counts.to_owned() });
        };
        let values: Vec<&str> = words.collect();
        let promised = u64::from(ni) + u64::from(nf) + u64::from(ns);
        if promised != values.len() as u64 {
            return Err(ObjProblem::TagLength { tag: name, promised, actual: values.len() });
        }
        let (integers, rest) = values.split_at(ni as usize);
        let (numbers, words) = rest.split_at(nf as usize);
        Ok(Tag {
            name,
            integers: parse_all(name, integers, "an index from 0")?,
            numbers: parse_all(name, numbers, "a number")?,
            words: words.to_vec(),
        })
    }

    fn creases(&self, line: u32, d: &mut Descriptor, source: &mut SourceLines) -> Result<(), ObjProblem> {
        let pairs = self.integers.chunks_exact(2);
        if !pairs.remainder().is_empty() || !self.sharpness_fits(pairs.len()) {
            return Err(self.shape("pairs of vertices with one sharpness for all, or one for each pair"));
        }
        for (i, pair) in pairs.enumerate() {
            d.creases.push(Crease { vertices: [pair[0], pair[1]], sharpness: self.sharpness(i) });
            source.creases.push(line);
        }
        Ok(())
    }

    fn corners(&self, line: u32, d: &mut Descriptor, source: &mut SourceLines) -> Result<(), ObjProblem> {
        if !self.sharpness_fits(self.integers.len()) {
            return Err(self.shape("vertices with one sharpness for all, or one for each"));
        }
        for (i, &vertex) in self.integers.iter().enumerate() {
            d.corners.push(Corner { vertex, sharpness: self.sharpness(i) });
            source.corners.push(line);
        }
        Ok(())
    }

    fn holes(&self, line: u32, d: &mut Descriptor, source: &mut SourceLines) -> Result<(), ObjProblem> {
        if self.integers.is_empty() || !self.numbers.is_empty() || !self.words.is_empty() {
            return Err(self.shape("faces and nothing else"));
        }
        d.holes.extend_from_slice(&self.integers);
        source.holes.resize(d.holes.len(), line);
        Ok(())
    }

    fn boundary(&self) -> Result<BoundaryInterpolation, ObjProblem> {
        match (&self.integers[..], self.numbers.len() + self.words.len()) {
            ([0], 0) => Ok(BoundaryInterpolation::None),
            ([1], 0) => Ok(BoundaryInterpolation::EdgeAndCorner),
            ([2], 0) => Ok(BoundaryInterpolation::EdgeOnly),
            _ => Err(self.shape("one integer: 0 (none), 1 (edge and corner) or 2 (edge only)")),
        }
    }

    fn word<T>(&self, choices: [(&'static str, T); 2]) -> Result<T, ObjProblem> {
        let expected = match choices[0].0 {
            "normal" => "one word: normal or chaikin",
            _ => "one word: catmark or smooth",
        };
        let [word] = self.words[..] else { return Err(self.shape(expected)) };
        if !self.integers.is_empty() || !self.numbers.is_empty() {
            return Err(self.shape(expected));
        }
        let chosen = choices.into_iter().find(|(name, _)| *name == word);
        chosen.map(|(_, value)| value).ok_or_else(|| self.shape(expected))
    }

    /// A tag that names `count` elements has one sharpness for all of them or one for each.
    fn sharpness_fits(&self, count: usize) -> bool {
        count > 0 && (self.numbers.len() == 1 || self.numbers.len() == count) && self.words.is_empty()
    }

    fn sharpness(&self, i: usize) -> f32 {
        self.numbers[if self.numbers.len() == 1 { 0 } else { i }]
    }

    fn shape(&self, expected: &'static str) -> ObjProblem {
        let (integers, numbers) = (self.integers.len(), self.numbers.len());
        let actual = match (integers, numbers, &self.words[..]) {
            (0, 0, []) => "has no values".to_owned(),
            (0, 0, [word]) => format!("says {}", crate::io::error::quote(word)),
            (1, 0, []) => format!("says {}", self.integers[0]),
            (_, _, words) => format!("has {integers} integers, {numbers} numbers and {} words", words.len()),
        };
        ObjProblem::TagShape { tag: self.name, actual, expected }
    }
}

fn parse_all<T: FromStr>(
    tag: &'static str,
    tokens: &[&str],
    expected: &'static str,
) -> Result<Vec<T>, ObjProblem> {
    let parse = |token: &&str| {
        token.parse().map_err(|_| ObjProblem::TagValue { tag, token: (*token).to_owned(), expected })
    };
    tokens.iter().map(parse).collect()
}
