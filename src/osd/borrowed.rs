//! What must be known of a refiner that somebody else made.

use super::bridge::ffi;
use super::{OsdError, OsdScheme, Refiner};
use crate::topology::{
    BoundaryInterpolation, Corner, Crease, CreasingMethod, Descriptor, TriangleSubdivision,
};

/// Why a refiner of somebody else cannot be used; every message ends with the remedy.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what they mean
pub enum BorrowError {
    #[error("the refiner is null: give a TopologyRefiner")]
    Null,
    #[error(
        "the refiner was refined adaptively, and forms are refined on whole levels: use RefineUniform (adaptive refinement is out of scope)"
    )]
    Adaptive,
    #[error(
        "the refiner orders the vertices of faces first: leave orderVerticesFromFacesFirst unset in the UniformOptions of RefineUniform"
    )]
    FacesFirst,
    #[error(transparent)]
    Osd(#[from] OsdError),
}

/// `OPENSUBDIV_VERSION_NUMBER` of the OpenSubdiv that this library was built with: 30500 for 3.5.0.
pub fn version() -> u32 {
    ffi::opensubdiv_version()
}

impl Refiner {
    /// This refiner, if every level of it can be asked for all that a hierarchy needs.
    pub(super) fn checked(self) -> Result<Self, BorrowError> {
        let made = self.0.description().map_err(OsdError::from)?;
        match () {
            () if made.levels > 0 && !made.uniform => Err(BorrowError::Adaptive),
            () if made.faces_first => Err(BorrowError::FacesFirst),
            () => Ok(self),
        }
    }

    /// The number of the finest level.
    ///
    /// # Errors
    /// If OpenSubdiv has a scheme that is not known here.
    pub fn num_levels(&self) -> Result<usize, OsdError> {
        Ok(self.0.description()?.levels as usize)
    }

    /// The scheme of OpenSubdiv by which it refines.
    ///
    /// # Errors
    /// If OpenSubdiv has a scheme that is not known here.
    pub fn scheme(&self) -> Result<OsdScheme, OsdError> {
        Ok([OsdScheme::Bilinear, OsdScheme::Catmark, OsdScheme::Loop][self.0.description()?.scheme as usize])
    }

    /// Level 0, as a cage that OpenSubdiv would refine in the same way. Its faces are counter-clockwise, and what
    /// the boundary options made sharp or a hole is tagged as such; edges that are sharp on any mesh, at
    /// boundaries and where other than two faces meet, are not named.
    ///
    /// # Errors
    /// If OpenSubdiv has a scheme that is not known here.
    pub fn descriptor(&self) -> Result<Descriptor, OsdError> {
        let made = self.0.description()?;
        let (cells, tags) = (self.incidence(0)?, self.tags(0)?);
        let mut faces_of_edge = vec![0u32; cells.edges.len()];
        for &e in &cells.face_edges {
            faces_of_edge[e as usize] += 1;
        }
        let named = |&e: &usize| tags.edge_sharpness[e] > 0.0 && faces_of_edge[e] == 2;
        let creases = (0..cells.edges.len()).filter(named);
        let corners = (0..cells.num_vertices).filter(|&v| tags.vertex_sharpness[v] > 0.0);
        let holes = (0..cells.face_sizes.len()).filter(|&f| tags.face_hole[f]);
        use BoundaryInterpolation as B;
        Ok(Descriptor {
            num_vertices: cells.num_vertices,
            creases: creases
                .map(|e| Crease { vertices: cells.edges[e], sharpness: tags.edge_sharpness[e] })
                .collect(),
            corners: corners
                .map(|v| Corner { vertex: v as u32, sharpness: tags.vertex_sharpness[v] })
                .collect(),
            holes: holes.map(|f| f as u32).collect(),
            face_sizes: cells.face_sizes,
            face_vertices: cells.face_vertices,
            boundary: [B::None, B::EdgeOnly, B::EdgeAndCorner][made.boundary as usize],
            creasing: if made.creasing { CreasingMethod::Chaikin } else { CreasingMethod::Uniform },
            triangles: if made.triangles {
                TriangleSubdivision::Smooth
            } else {
                TriangleSubdivision::Catmark
            },
            left_handed: false,
        })
    }
}
