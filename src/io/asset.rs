use super::{IoError, Positions};
use crate::topology::{Cage, CollapseReport, Descriptor, Element};

/// A control cage as a file gives it, and where in the file each element stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Asset {
    /// The name that messages use, usually the path.
    pub name: String,
    /// Polygons, sharp features, holes, options. All indices start at 0.
    pub descriptor: Descriptor,
    /// One position for each vertex.
    pub positions: Positions,
    /// The line of each element.
    pub source: SourceLines,
    /// What the reader passed over, one sentence each.
    pub notes: Vec<String>,
}

impl Asset {
    /// The checked cage.
    ///
    /// # Errors
    /// [`IoError::Topology`], with the line of the element that is wrong.
    pub fn cage(&self) -> Result<Cage, IoError> {
        Cage::new(self.descriptor.clone()).map_err(|source| IoError::Topology {
            file: self.name.clone(),
            line: source.element().and_then(|element| self.source.line(element)),
            source,
        })
    }

    /// [`Descriptor::collapse`]; elements keep their lines.
    pub fn collapse(&mut self) -> CollapseReport {
        let before = self.descriptor.clone();
        let report = self.descriptor.collapse();
        if !report.is_empty() {
            self.source.follow(&before, &self.descriptor, &report);
        }
        report
    }
}

/// The line on which each element of a cage stands. Lines start at 1, elements at 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SourceLines {
    pub(super) vertices: Vec<u32>,
    pub(super) faces: Vec<u32>,
    pub(super) creases: Vec<u32>,
    pub(super) corners: Vec<u32>,
    pub(super) holes: Vec<u32>,
}

impl SourceLines {
    /// The line of an element; `None` if the file has no such element.
    pub fn line(&self, element: Element) -> Option<usize> {
        let line = match element {
            Element::Vertex(v) => self.vertices.get(v as usize),
            Element::Face(f) => self.faces.get(f as usize),
            Element::Crease(i) => self.creases.get(i),
            Element::Corner(i) => self.corners.get(i),
            Element::Hole(i) => self.holes.get(i),
        };
        line.map(|&line| line as usize)
    }

    /// Moves the lines to the numbers that elements have after a collapse.
    fn follow(&mut self, before: &Descriptor, after: &Descriptor, report: &CollapseReport) {
        self.faces = report.kept.iter().map(|&old| self.faces[old as usize]).collect();
        // A collapse drops creases and holes and leaves the order of the rest, so what stays is found by
        // one pass over both lists. Sharpness is not compared: it may be NaN.
        let crease = |d: &Descriptor| d.creases.iter().map(|c| c.vertices).collect::<Vec<_>>();
        self.creases = subsequence(&crease(before), &crease(after), &self.creases);
        // Old number of a hole: the check names one that is out of range, and it has not moved.
        let old = |&hole: &u32| report.kept.get(hole as usize).copied().unwrap_or(hole);
        let after: Vec<u32> = after.holes.iter().map(old).collect();
        self.holes = subsequence(&before.holes, &after, &self.holes);
    }
}

/// The lines of those items of `before` that occur, in order, in `after`.
fn subsequence<T: PartialEq>(before: &[T], after: &[T], lines: &[u32]) -> Vec<u32> {
    let mut next = after.iter().peekable();
    let stays = |item: &T| next.next_if(|&wanted| wanted == item).is_some();
    let kept: Vec<bool> = before.iter().map(stays).collect();
    lines.iter().zip(kept).filter(|(_, kept)| *kept).map(|(&line, _)| line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::obj;

    const POLES: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n\
        f 1 1 2 2\nf 1 2 3 4\nf 2 2 5 3\nf 5 6 3\n\
        t hole 2/0/0 0 1\nt crease 2/1/0 0 1 2\nt hole 1/0/0 9\nt crease 2/1/0 4 5 -1\n";

    #[test]
    fn lines_follow_a_collapse() {
        let mut asset = obj::parse("poles.obj", POLES.as_bytes()).unwrap();
        let report = asset.collapse();
        assert_eq!((report.removed, report.reduced), (vec![0], vec![2]));
        assert_eq!(asset.source.line(Element::Face(0)), Some(8));
        assert_eq!(asset.source.line(Element::Face(1)), Some(9));
        // Hole 0 went with its face; hole 1 is now hole 0 of face 0, and the bad one keeps its line.
        assert_eq!(asset.descriptor.holes, [0, 9]);
        assert_eq!(asset.source.line(Element::Hole(0)), Some(11));
        assert_eq!(asset.source.line(Element::Hole(1)), Some(13));
        let error = asset.cage().unwrap_err().to_string();
        assert!(error.starts_with("poles.obj: line 14: crease 1 has sharpness -1"), "{error}");
    }
}
