use super::cage::EdgeLookup;

/// What happens at the boundary of the surface: OpenSubdiv's `VtxBoundaryInterpolation`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoundaryInterpolation {
    /// The surface does not reach the boundary: faces that touch it are treated as holes.
    None,
    /// Boundary edges are creases, corners are rounded. What OpenSubdiv reads in an OBJ without a tag.
    #[default]
    EdgeOnly,
    /// Boundary edges are creases and boundary vertices of one face are corners. USD's default.
    EdgeAndCorner,
}

/// How semi-sharp creases decay from level to level: OpenSubdiv's `CreasingMethod`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CreasingMethod {
    /// Sharpness falls by one a level.
    #[default]
    Uniform,
    /// Sharpness is smoothed along the crease as it falls (Chaikin's rule).
    Chaikin,
}

/// The rule for edges next to triangles in Catmull-Clark: OpenSubdiv's `TriangleSubdivision`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TriangleSubdivision {
    /// The ordinary rule.
    #[default]
    Catmark,
    /// Weights that look smoother on triangles.
    Smooth,
}

/// A sharp edge, named by its two end vertices in either order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crease {
    /// The end vertices.
    pub vertices: [u32; 2],
    /// 0 is smooth, 10 and above infinitely sharp, between them semi-sharp.
    pub sharpness: f32,
}

/// A sharp vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// The vertex.
    pub vertex: u32,
    /// 0 is smooth, 10 and above infinitely sharp, between them semi-sharp.
    pub sharpness: f32,
}

/// A control cage as a file or a caller gives it: polygons, sharp features, holes, options. Plain data,
/// unchecked; [`super::Cage::new`] checks it. All indices start at 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Descriptor {
    /// The number of vertices, isolated ones included.
    pub num_vertices: usize,
    /// The number of vertices of each face.
    pub face_sizes: Vec<u32>,
    /// The vertices of all faces, face after face, counter-clockwise (clockwise if `left_handed`).
    pub face_vertices: Vec<u32>,
    /// Sharp edges. An edge named twice takes the later value.
    pub creases: Vec<Crease>,
    /// Sharp vertices.
    pub corners: Vec<Corner>,
    /// Faces that belong to the complex but are left out of what is written.
    pub holes: Vec<u32>,
    /// The boundary rule.
    pub boundary: BoundaryInterpolation,
    /// The decay of semi-sharp creases.
    pub creasing: CreasingMethod,
    /// The rule next to triangles.
    pub triangles: TriangleSubdivision,
    /// Faces are listed clockwise. They are turned: the first vertex stays, the rest reverse.
    pub left_handed: bool,
}

/// What [`Descriptor::collapse`] did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CollapseReport {
    /// Faces (old numbers) that lost repeated vertices and stayed.
    pub reduced: Vec<u32>,
    /// Faces (old numbers) that fell below three vertices and went.
    pub removed: Vec<u32>,
    /// For each face that stays, its old number.
    pub kept: Vec<u32>,
}

impl CollapseReport {
    /// Whether nothing had to be done.
    pub fn is_empty(&self) -> bool {
        self.reduced.is_empty() && self.removed.is_empty()
    }
}

impl Descriptor {
    /// Drops the repetition of a vertex that follows itself in a face, as the collapsed quads at a pole
    /// have it: a quad becomes a triangle, a face left with fewer than three vertices goes. Holes keep
    /// naming the same faces; creases on an edge that went are dropped with it.
    ///
    /// A face that meets a vertex twice without the two being neighbours (a bow tie) is left alone, and
    /// [`super::Cage::new`] refuses it.
    pub fn collapse(&mut self) -> CollapseReport {
        let mut report = CollapseReport::default();
        let (mut sizes, mut vertices) = (Vec::new(), Vec::with_capacity(self.face_vertices.len()));
        let mut offset = 0;
        for (f, &size) in self.face_sizes.iter().enumerate() {
            let end = (offset + size as usize).min(self.face_vertices.len());
            let old = &self.face_vertices[offset.min(end)..end];
            offset = end;
            let start = vertices.len();
            for (i, &v) in old.iter().enumerate() {
                let previous = old[(i + old.len() - 1) % old.len()];
                if v != previous || old.len() == 1 {
                    vertices.push(v);
                }
            }
            let kept = vertices.len() - start;
            // Only a repetition is mended here: a face that was too small is reported by the check.
            if kept < old.len() && kept < 3 {
                vertices.truncate(start);
                report.removed.push(f as u32);
                continue;
            }
            if kept < old.len() {
                report.reduced.push(f as u32);
            }
            sizes.push(kept as u32);
            report.kept.push(f as u32);
        }
        if report.is_empty() {
            return report;
        }

        let mut new_number = vec![None; self.face_sizes.len()];
        for (new, &old) in report.kept.iter().enumerate() {
            new_number[old as usize] = Some(new as u32);
        }
        // A hole out of range stays as it is, so that the check can name it.
        self.holes.retain_mut(|hole| match new_number.get(*hole as usize) {
            Some(Some(new)) => {
                *hole = *new;
                true
            }
            Some(None) => false,
            None => true,
        });
        let before = EdgeLookup::new(self.num_vertices, &self.face_sizes, &self.face_vertices);
        let after = EdgeLookup::new(self.num_vertices, &sizes, &vertices);
        self.creases.retain(|c| !before.contains(c.vertices) || after.contains(c.vertices));
        self.face_sizes = sizes;
        self.face_vertices = vertices;
        report
    }
}
