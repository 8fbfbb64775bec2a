//! What a face's configuration makes of it: a polynomial, or children with configurations of their own.
//!
//! Next to an irregular vertex or a feature a face is evaluated by exact local subdivision, as Stam did for
//! Catmull-Clark surfaces: three of its children (on triangles too) have regular surroundings and the fourth is
//! like itself. The maps from the cells round a face to those round its children are the same wherever the
//! configuration is, and are read off a [`Model`] once.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use super::frame::child_corner;
use super::model::{LEVELS, Model, block};
use super::neighbourhood::{Cells, Configuration, around_face, origin, patch_cells};
use super::vertex::{self, VertexTable};
use super::{quad, triangle};
use crate::hierarchy::{HierarchyError, Level};
use crate::osd::{Rule, Tags};
use crate::scheme::{BoundaryRule, Scheme, Variant};
use crate::sparse::{Csr, multiply};
use crate::topology::{Mesh, SplitKind};

/// The table of one configuration.
#[derive(Clone, Debug)]
pub struct Table {
    /// The numbers of cells.
    pub sizes: [usize; 3],
    /// The polynomial coefficients over the cells, by degree, if the limit is a polynomial here; where it is
    /// not but tends to it, the polynomial that takes over when children get too small.
    pub polynomial: Option<[Csr; 3]>,
    /// The four children, by number, if the limit is no polynomial.
    pub children: Vec<Child>,
    /// The limit at the vertex, if it is not in the polynomial.
    pub vertex: Option<Arc<VertexTable>>,
}

/// A child of a face.
#[derive(Clone, Debug)]
pub struct Child {
    /// How many corners, counter-clockwise, its own frame is turned from its parent's.
    pub turn: usize,
    /// Its table; `None` if it is a polynomial, and the maps lead to its coefficients.
    pub table: Option<usize>,
    /// From the cells of the face to those of the child, by degree.
    pub maps: [Csr; 3],
}

/// What a table is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Key {
    /// The face of a corner with this configuration.
    Face(Configuration),
    /// A child, not the first, of a face with this configuration, where [`Tables::pulls`]: its surroundings look
    /// regular, but the irregular vertex beside it still pulls on a midpoint. They are told from the first corner
    /// that can, beginning with the one where the child's frame starts.
    Beside(Configuration, usize),
    /// A face of a Whitney scheme, whose cells are its own vertices, edges and itself.
    Whitney,
}

/// The tables of the configurations that were asked for.
pub struct Tables {
    kind: SplitKind,
    scheme: Scheme,
    list: Vec<Table>,
    numbers: HashMap<Key, usize>,
    /// Models and vertices serve all positions of a configuration: they are kept under the first.
    models: HashMap<(Configuration, usize), Arc<Model>>,
    vertices: HashMap<Configuration, Arc<VertexTable>>,
}

impl Tables {
    /// No tables yet.
    pub fn new(kind: SplitKind, scheme: Scheme) -> Self {
        Tables {
            kind,
            scheme,
            list: Vec::new(),
            numbers: HashMap::new(),
            models: HashMap::new(),
            vertices: HashMap::new(),
        }
    }

    /// Forgets the models. What is asked for later makes its own again.
    pub fn finish(&mut self) {
        self.models.clear();
    }

    fn model(&mut self, c: Configuration, levels: usize) -> Result<Arc<Model>, HierarchyError> {
        Ok(match self.models.entry((c.anywhere(), levels)) {
            Entry::Occupied(known) => known.get().clone(),
            Entry::Vacant(new) => {
                new.insert(Arc::new(Model::new(self.kind, self.scheme, c, levels)?)).clone()
            }
        })
    }

    fn vertex(&mut self, c: Configuration) -> Result<Arc<VertexTable>, HierarchyError> {
        Ok(match self.vertices.entry(c.anywhere()) {
            Entry::Occupied(known) => known.get().clone(),
            Entry::Vacant(new) => new.insert(Arc::new(vertex::table(self.kind, self.scheme, c)?)).clone(),
        })
    }

    /// A table by number.
    #[inline]
    pub fn get(&self, number: usize) -> &Table {
        &self.list[number]
    }

    /// The number of a table, which is made if it is new.
    ///
    /// # Errors
    /// If a model does not fit memory or OpenSubdiv fails.
    pub fn number(&mut self, key: Key) -> Result<usize, HierarchyError> {
        if let Some(&number) = self.numbers.get(&key) {
            return Ok(number);
        }
        let number = self.list.len();
        self.numbers.insert(key, number);
        let empty = Table { sizes: [0; 3], polynomial: None, children: Vec::new(), vertex: None };
        self.list.push(empty); // children may have the same configuration
        match key {
            Key::Face(configuration) => self.fill_face(number, configuration)?,
            Key::Beside(configuration, child) => self.fill_beside(number, configuration, child)?,
            Key::Whitney => {
                let (sizes, polynomial) = match self.kind {
                    SplitKind::Quad => ([4, 4, 1], quad::whitney()),
                    SplitKind::Triangle => ([3, 3, 1], triangle::whitney()),
                };
                self.list[number].sizes = sizes;
                self.list[number].polynomial = Some(polynomial);
            }
        }
        Ok(number)
    }

    fn fill_face(&mut self, number: usize, c: Configuration) -> Result<(), HierarchyError> {
        let model = self.model(c, LEVELS)?;
        let (corner, cells) = model.patch(LEVELS - 1, c);
        let polynomial = self.polynomial(&model, c, &cells)?;
        let is_polynomial = polynomial.is_some();
        self.list[number].sizes = sizes(&cells);
        self.list[number].polynomial = polynomial;
        if !is_polynomial || self.only_tends_to_polynomial(c) {
            self.list[number].children = self.children(&model, LEVELS - 1, corner, &cells, Some(c))?;
        }
        if !is_polynomial {
            self.list[number].vertex = Some(self.vertex(c)?);
        }
        Ok(())
    }

    fn fill_beside(&mut self, number: usize, c: Configuration, child: usize) -> Result<(), HierarchyError> {
        let model = self.model(c, LEVELS + 1)?;
        let hierarchy = model.hierarchy();
        let (parent, mesh) = (hierarchy.level(LEVELS - 1).mesh(), hierarchy.level(LEVELS).mesh());
        let (corner, _) = model.patch(LEVELS - 1, c);
        let corner = child_corner(hierarchy.refinement(LEVELS).split(), parent, mesh, corner, child);
        let (start, _, cells) = self.own_patch(hierarchy.level(LEVELS), corner);
        self.list[number].sizes = sizes(&cells);
        self.list[number].children = self.children(&model, LEVELS, start, &cells, None)?;
        Ok(())
    }

    /// Whether an irregular vertex changes the rules of edges that it only looks at, as modified Loop's do, so that
    /// faces beside its own are not polynomials yet.
    pub fn pulls(&self, c: Configuration) -> bool {
        let modified = matches!(self.scheme, Scheme::Loop(Variant::ModifiedLoop, _));
        let regular = match c.rule {
            Rule::Smooth | Rule::Dart => 6,
            Rule::Crease => 3,
            Rule::Corner => return false,
        };
        modified && c.faces != regular
    }

    /// Where the surroundings of the face of a corner of a model are told from, what they are, and its cells.
    fn own_patch(&self, level: &Level, corner: u32) -> (u32, Configuration, Cells) {
        let (mesh, tags) = (level.mesh(), level.tags());
        let plain = |v| is_plain(self.kind, mesh, tags, v);
        let start = origin(mesh, tags, plain, corner).expect("one level parts all features");
        let (configuration, fan) = around_face(mesh, tags, start);
        (start, configuration, patch_cells(mesh, configuration, &fan))
    }

    /// Straight boundaries and creases, and right angles of quads, reflect the regular rules, unless a triangle
    /// scheme has others there.
    fn polynomial(
        &self,
        model: &Model,
        c: Configuration,
        cells: &Cells,
    ) -> Result<Option<[Csr; 3]>, HierarchyError> {
        let regular = match self.kind {
            SplitKind::Quad => [(Rule::Smooth, true, 4), (Rule::Crease, false, 2), (Rule::Corner, false, 1)],
            SplitKind::Triangle => {
                [(Rule::Smooth, true, 6), (Rule::Crease, false, 3), (Rule::Corner, false, 1)]
            }
        };
        if !c.pinched && !regular.contains(&(c.rule, c.cyclic, c.faces)) {
            return Ok(None);
        }
        let mesh = model.hierarchy().level(LEVELS - 1).mesh();
        Ok(Some(match self.kind {
            SplitKind::Quad => quad::grids(mesh, cells, c),
            SplitKind::Triangle => (*triangle::polynomials(c)?).clone(),
        }))
    }

    fn only_tends_to_polynomial(&self, c: Configuration) -> bool {
        let own_rule = matches!(self.scheme, Scheme::Loop(_, BoundaryRule::Thesis | BoundaryRule::Dct));
        own_rule && (c.rule != Rule::Smooth || c.pinched)
    }

    /// The children of the face of a corner on level `top`; `of` is the configuration there, if it may pull.
    fn children(
        &mut self,
        model: &Model,
        top: usize,
        corner: u32,
        cells: &Cells,
        of: Option<Configuration>,
    ) -> Result<Vec<Child>, HierarchyError> {
        let hierarchy = model.hierarchy();
        let (parent, bottom) = (hierarchy.level(top).mesh(), hierarchy.level(top + 1));
        let split = hierarchy.refinement(top + 1).split();
        let operators = model.operators(top + 1);
        let (steps, from) = ([&operators.s0, &operators.s1, &operators.s2], cells.signed());
        let mut children = Vec::with_capacity(4);
        for child in 0..4 {
            let corner = child_corner(split, parent, bottom.mesh(), corner, child);
            let (start, configuration, cells) = self.own_patch(bottom, corner);
            let size = bottom.mesh().face_size(bottom.mesh().corner_face(corner)) as u32;
            let turn = ((start + size - corner) % size) as usize;
            let to = cells.signed();
            let maps = [0, 1, 2].map(|k| block(steps[k], &from[k], &to[k]));
            let pulled = of.filter(|&of| child != 0 && self.pulls(of));
            let number = match pulled {
                Some(of) => self.number(Key::Beside(of, child))?,
                None => self.number(Key::Face(configuration))?,
            };
            children.push(match &self.get(number).polynomial {
                Some(rows) if !self.only_tends_to_polynomial(configuration) => {
                    Child { turn, table: None, maps: [0, 1, 2].map(|k| multiply(&rows[k], &maps[k])) }
                }
                _ => Child { turn, table: Some(number), maps },
            });
        }
        Ok(children)
    }
}

fn sizes(cells: &Cells) -> [usize; 3] {
    [cells.vertices.len(), cells.edges.len(), cells.faces.len()]
}

/// Whether a vertex is regular, smooth and inside the surface.
pub fn is_plain(kind: SplitKind, mesh: &Mesh, tags: &Tags, v: u32) -> bool {
    let regular = match kind {
        SplitKind::Quad => 4,
        SplitKind::Triangle => 6,
    };
    let mut fans = mesh.fans(v);
    tags.vertex_rule[v as usize] == Rule::Smooth
        && fans.len() == 1
        && fans.next().is_some_and(|fan| fan.cyclic && fan.corners.len() == regular)
}
