use std::sync::Arc;

use nalgebra::{Matrix4, Point3};

use super::fields::Fields;
use super::{Form1, Format, Forms, IoError, Positions, usd};
use crate::cochain::Cochain;
use crate::osd::OsdScheme;
use crate::topology::{Cage, CollapseReport, Descriptor, Element, Mesh};

/// A control cage as a file gives it, and where in the file each element stands.
#[derive(Clone, Debug, Default)]
pub struct Asset {
    /// The name that messages use, usually the path.
    pub name: String,
    /// Which mesh of the file, where a file holds several: a prim path, the name of a node.
    pub prim: Option<String>,
    /// Polygons, sharp features, holes, options. All indices start at 0.
    pub descriptor: Descriptor,
    /// One position for each vertex, in the space of the mesh: [`Asset::bake`] takes it to that of the
    /// file. Of the first frame, if there are frames.
    pub positions: Positions,
    /// Forms that the file carries itself.
    pub forms: Forms,
    /// The scheme that the file asks for, if it says.
    pub scheme: Option<OsdScheme>,
    /// The line of each element, in formats that have lines.
    pub source: SourceLines,
    /// What the reader passed over, one sentence each.
    pub notes: Vec<String>,
    /// Takes positions from the space of the mesh to that of the file.
    pub placement: Option<Matrix4<f64>>,
    /// The time samples that were asked for, ascending.
    pub frames: Vec<Frame>,
    /// The USD stage that the mesh is from: the writer of USD keeps what else is on it.
    pub stage: Option<Arc<usd::Stage>>,
}

/// A moving mesh at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// In time codes of the stage.
    pub time: f64,
    /// One position for each vertex.
    pub positions: Positions,
    /// As [`Asset::placement`], at that time.
    pub placement: Option<Matrix4<f64>>,
}

impl Asset {
    /// The checked cage.
    ///
    /// # Errors
    /// [`IoError::Topology`], with the line of the element that is wrong.
    pub fn cage(&self) -> Result<Cage, IoError> {
        Cage::new(self.descriptor.clone()).map_err(|source| IoError::Topology {
            file: self.label(),
            line: source.element().and_then(|element| self.source.line(element)),
            source,
        })
    }

    /// The name of the file and, where it holds several meshes, that of the mesh.
    pub fn label(&self) -> String {
        match &self.prim {
            Some(prim) => format!("{}: {prim}", self.name),
            None => self.name.clone(),
        }
    }

    /// [`Descriptor::collapse`]; elements keep their lines.
    pub fn collapse(&mut self) -> CollapseReport {
        let before = self.descriptor.clone();
        let report = self.descriptor.collapse();
        if !report.is_empty() {
            self.source.follow(&before, &self.descriptor, &report);
            // A face that went or shrank has no place in the file's lists of values.
            if let Some(values) = &mut self.forms.form2 {
                *values = report.kept.iter().filter_map(|&f| values.get(f as usize).copied()).collect();
            }
            if let Some(Form1::Corners(_)) = self.forms.form1 {
                self.forms.form1 = None;
                self.notes.push("the 1-form of the file is not kept by --collapse: its corners went".into());
            }
        }
        report
    }

    /// The forms that the file carries, on level 0.
    ///
    /// # Errors
    /// [`IoError::Content`] if they do not fit the mesh, or the two sides of an edge differ.
    ///
    /// # Panics
    /// If `mesh` is not level 0 of this cage.
    pub fn fields(&self, mesh: &Mesh) -> Result<Fields, IoError> {
        let fields = self.forms.on(&self.descriptor, mesh);
        fields
            .map_err(|problem| IoError::content(&self.name, self.prim.as_deref().unwrap_or("forms"), problem))
    }

    /// Takes the mesh out of its file, to be written as another `format`: its positions go to the space of
    /// the file (for glTF, to metres with Y up, if the file has other units), and what else is there is
    /// forgotten and named in the notes. Circulations and fluxes do not change. Where the placement mirrors, faces change
    /// their handedness, so that the outside stays outside.
    pub fn bake(&mut self, format: Format) {
        let behind = self.stage.as_ref().and_then(|stage| stage.left_behind());
        self.notes.extend(behind.map(|what| format!("left behind in {}: {what}", self.name)));
        let is_gltf = matches!(format, Format::Glb | Format::Gltf);
        if let Some(to_gltf) = self.stage.as_ref().filter(|_| is_gltf).map(|stage| stage.to_gltf()) {
            let all = self.frames.iter_mut().map(|frame| &mut frame.placement);
            for placement in all.chain([&mut self.placement]) {
                *placement = Some(to_gltf * placement.unwrap_or_else(Matrix4::identity));
            }
        }
        let mirrors = |placement: &Option<Matrix4<f64>>| {
            placement.is_some_and(|m| m.fixed_view::<3, 3>(0, 0).determinant() < 0.0)
        };
        let first = self.frames.first().map_or(&self.placement, |frame| &frame.placement);
        self.descriptor.left_handed ^= mirrors(first);
        let place = |placement: &mut Option<Matrix4<f64>>, positions: &mut Positions| {
            if let Some(matrix) = placement.take() {
                let move_ = |x| matrix.transform_point(&Point3::from(x)).coords;
                *positions = Cochain::new(positions.values().iter().map(|&x| move_(x)).collect());
            }
        };
        for frame in &mut self.frames {
            place(&mut frame.placement, &mut frame.positions);
        }
        place(&mut self.placement, &mut self.positions);
        if let Some(frame) = self.frames.first() {
            self.positions = frame.positions.clone();
        }
        self.stage = None;
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
        if self.faces.is_empty() {
            return; // a format without lines
        }
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
