//! From a cage to a surface that can be evaluated.

use rayon::prelude::*;

use super::super::frame::child_corner;
use super::super::neighbourhood::{Configuration, around_face, origin, patch_cells};
use super::super::tables::{Key, Tables, is_plain};
use super::super::unsettled;
use super::{LimitSurface, Patch, SurfaceError};
use crate::hierarchy::{Hierarchy, Level};
use crate::osd::Rule;
use crate::scheme::Scheme;
use crate::topology::{Cage, Mesh, SplitKind};

impl LimitSurface {
    /// Refines `cage` as far as evaluation needs: once where irregular vertices or features share a face, and
    /// until semi-sharp creases have decayed.
    ///
    /// # Errors
    /// If the cage cannot be refined that far, see [`Hierarchy::new`], or has a vertex that evaluation does not
    /// know.
    pub fn new(cage: &Cage, scheme: Scheme) -> Result<Self, SurfaceError> {
        Self::with_levels(cage, scheme, 0)
    }

    /// [`LimitSurface::new`], refined so many times at least: the same surface, with finer levels in its
    /// [`LimitSurface::hierarchy`].
    ///
    /// # Errors
    /// As for [`LimitSurface::new`].
    pub fn with_levels(cage: &Cage, scheme: Scheme, least: usize) -> Result<Self, SurfaceError> {
        let mut levels = unsettled::levels_to_settle(cage, scheme)?.max(least);
        // One level parts the features of a face, but for those of a triangle with three sharp edges.
        loop {
            let hierarchy = Hierarchy::new(cage, scheme, levels)?;
            if matches!(scheme, Scheme::Whitney | Scheme::Bilinear) {
                return Self::whitney(hierarchy);
            }
            let Some(origins) = origins(hierarchy.finest(), hierarchy.split_kind()) else {
                levels += 1;
                continue;
            };
            let tables = Tables::new(hierarchy.split_kind(), scheme);
            let (mesh, tags) = (hierarchy.finest().mesh(), hierarchy.finest().tags());
            let pulled = origins.iter().any(|&corner| tables.pulls(around_face(mesh, tags, corner).0));
            return match pulled {
                false => Self::prepare(hierarchy, tables, |_| None),
                true => {
                    let hierarchy = Hierarchy::new(cage, scheme, levels + 1)?;
                    let beside = beside(&hierarchy, &tables, &origins);
                    Self::prepare(hierarchy, tables, |face| beside[face])
                }
            };
        }
    }

    fn whitney(hierarchy: Hierarchy) -> Result<Self, SurfaceError> {
        let mut tables = Tables::new(hierarchy.split_kind(), hierarchy.scheme());
        let table = tables.number(Key::Whitney)? as u32;
        let (mut patches, mut cells) = (Vec::new(), Vec::new());
        let mesh = hierarchy.finest().mesh();
        for face in 0..mesh.num_faces() as u32 {
            patches.push(Patch { origin: 0, table, cells: cells.len() as u32 });
            cells.extend(mesh.face_vertices(face));
            cells.extend(mesh.face_half_edges(face).iter().map(|h| h.0));
            cells.push(face);
        }
        Ok(LimitSurface { hierarchy, tables, patches, cells })
    }

    /// `beside` says which faces are pulled at from beside them.
    fn prepare(
        hierarchy: Hierarchy,
        mut tables: Tables,
        beside: impl Fn(usize) -> Option<(Key, u32)> + Sync,
    ) -> Result<Self, SurfaceError> {
        let finest = hierarchy.finest();
        let (mesh, tags) = (finest.mesh(), finest.tags());
        let origins = origins(finest, hierarchy.split_kind()).expect("features stay apart");
        let start = |face: usize| beside(face).map_or(origins[face], |(_, start)| start);
        let around = |face: usize| around_face(mesh, tags, start(face));
        let faces = 0..mesh.num_faces();
        let key = |face| {
            let (configuration, fan) = around(face);
            check(mesh, configuration, &fan)?;
            Ok(beside(face).map_or(Key::Face(configuration), |(key, _)| key))
        };
        let keys: Vec<Result<Key, SurfaceError>> = faces.clone().into_par_iter().map(key).collect();

        let mut patches = Vec::with_capacity(mesh.num_faces());
        let mut num_cells = 0;
        for (face, key) in keys.into_iter().enumerate() {
            let table = tables.number(key?)?;
            let first = mesh.corners(face as u32).start;
            patches.push(Patch {
                origin: (start(face) - first) as u8,
                table: table as u32,
                cells: num_cells as u32,
            });
            num_cells += tables.get(table).sizes.iter().sum::<usize>();
        }
        let cells: Vec<Vec<u32>> = faces
            .into_par_iter()
            .fold(Vec::new, |mut cells, face| {
                let (configuration, fan) = around(face);
                let found = patch_cells(mesh, configuration, &fan);
                cells.extend(found.vertices);
                cells.extend(found.edges.iter().map(|h| h.0));
                cells.extend(found.faces);
                cells
            })
            .collect();
        let cells = cells.concat();
        tables.finish();
        Ok(LimitSurface { hierarchy, tables, patches, cells })
    }
}

/// The corner of each face from which its surroundings are told; `None` if features share a face that it cannot
/// be told from.
fn origins(level: &Level, kind: SplitKind) -> Option<Vec<u32>> {
    let (mesh, tags) = (level.mesh(), level.tags());
    if kind == SplitKind::Quad && (0..mesh.num_faces() as u32).any(|f| mesh.face_size(f) != 4) {
        return None;
    }
    let find = |face| origin(mesh, tags, |v| is_plain(kind, mesh, tags, v), mesh.corners(face).start);
    (0..mesh.num_faces() as u32).into_par_iter().map(find).collect()
}

/// For each face of the finest level, whether an irregular vertex pulls at it from beside it, and the corner that
/// its surroundings are then told from; `origins` are those of the level above.
fn beside(hierarchy: &Hierarchy, tables: &Tables, origins: &[u32]) -> Vec<Option<(Key, u32)>> {
    let level = hierarchy.num_levels();
    let (above, mesh) = (hierarchy.level(level - 1), hierarchy.finest().mesh());
    let tags = hierarchy.finest().tags();
    let plain = |v| is_plain(hierarchy.split_kind(), mesh, tags, v);
    let split = hierarchy.refinement(level).split();
    let mut beside = vec![None; mesh.num_faces()];
    for &corner in origins {
        let (configuration, _) = around_face(above.mesh(), above.tags(), corner);
        for child in (1..4).filter(|_| tables.pulls(configuration)) {
            let corner = child_corner(split, above.mesh(), mesh, corner, child);
            let start = origin(mesh, tags, plain, corner).expect("features stay apart");
            beside[mesh.corner_face(corner) as usize] = Some((Key::Beside(configuration, child), start));
        }
    }
    beside
}

/// A crease vertex moves by its two sharp edges: they must be those that bound the faces in question.
fn check(mesh: &Mesh, c: Configuration, fan: &[u32]) -> Result<(), SurfaceError> {
    let first = mesh.corner_half_edge(fan[0]).edge();
    let last = mesh.corner_half_edge(mesh.previous_corner(fan[fan.len() - 1])).edge();
    match c.rule == Rule::Crease && (c.cyclic || first == last) {
        true => Err(SurfaceError::NonManifold { vertex: mesh.corner_vertex(fan[0]) }),
        false => Ok(()),
    }
}
