//! Levels of refinement with their operators.

mod assembly;
mod budget;
mod composed;
mod hubs;
mod kernel;
mod level;
mod refinement;
mod rows;
mod stencils;
mod wheel;

pub(crate) use budget::available_memory;
pub use kernel::Workspace;
pub use level::Level;
pub use refinement::{Operators, Refinement};
pub use stencils::StepStencils;

use std::sync::Arc;

use crate::cochain::{Cochain, Quantity};
use crate::osd::{MAX_LEVELS, OsdError, OsdScheme, Refiner};
use crate::scheme::{Scheme, SchemeError};
use crate::sparse::Csr;
use crate::topology::{Cage, Split, SplitKind, TopologyError};

/// A control cage refined a number of times, with the operators between the levels.
///
/// Level 0 is the cage. Building it asks OpenSubdiv for each level's topology and masks once; after that
/// it is plain data, shared freely between threads.
#[derive(Clone, Debug)]
pub struct Hierarchy {
    cage: Cage,
    scheme: Scheme,
    kind: SplitKind,
    levels: Vec<Level>,
    /// `refinements[l]` leads from level `l` to level `l + 1`.
    refinements: Vec<Arc<Refinement>>,
}

/// Why a hierarchy cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages say what the fields are
pub enum HierarchyError {
    #[error("{levels} levels: OpenSubdiv refines at most {MAX_LEVELS}, ask for fewer")]
    TooManyLevels { levels: usize },
    #[error(
        "level {level} is too large: {faces} faces are more than 32-bit numbers can index, ask for fewer levels"
    )]
    TooManyFaces { level: usize, faces: u128 },
    #[error(
        "refining to level {level} ({faces} faces) needs about {needed_mib} MiB of memory and {available_mib} MiB are free: ask for fewer levels"
    )]
    TooMuchMemory { level: usize, faces: u128, needed_mib: u128, available_mib: u128 },
    #[error(
        "this OpenSubdiv numbers the children of level {level} in an order that formwork does not know: use version 3.5 or 3.6"
    )]
    UnknownNumbering { level: usize },
    #[error(
        "the refiner's scheme is {actual:?}, and this scheme of forms goes with {needed:?}: choose another"
    )]
    OtherScheme { actual: OsdScheme, needed: OsdScheme },
    #[error(transparent)]
    Cage(#[from] TopologyError),
    #[error(transparent)]
    Scheme(#[from] SchemeError),
    #[error(transparent)]
    Osd(#[from] OsdError),
}

impl Hierarchy {
    /// Refines `cage` to level `levels` (0 keeps the cage alone).
    ///
    /// # Errors
    /// If the scheme does not take the cage, there are too many levels, the result would not fit memory or 32-bit numbers, or OpenSubdiv
    /// fails.
    pub fn new(cage: &Cage, scheme: Scheme, levels: usize) -> Result<Self, HierarchyError> {
        Self::with_progress(cage, scheme, levels, |_| ())
    }

    /// [`Hierarchy::new`], calling `progress(level)` each time a level is finished.
    ///
    /// # Errors
    /// As for [`Hierarchy::new`].
    pub fn with_progress(
        cage: &Cage,
        scheme: Scheme,
        levels: usize,
        progress: impl FnMut(usize),
    ) -> Result<Self, HierarchyError> {
        let (refiner, kind) = refiner(cage, scheme, levels, false)?;
        Self::read(cage.clone(), scheme, kind, &refiner, levels, progress)
    }

    /// All levels of a refiner that somebody else made (see [`Refiner::borrow`]), in its own numbering. It is read
    /// and not kept.
    ///
    /// # Errors
    /// If its level 0 is not a [`Cage`], the scheme takes another scheme of OpenSubdiv or not this mesh, the
    /// result would not fit memory, or OpenSubdiv fails.
    pub fn from_refiner(refiner: &Refiner, scheme: Scheme) -> Result<Self, HierarchyError> {
        let cage = Cage::new(refiner.descriptor()?)?;
        let (kind, levels) = (scheme.split(&cage.descriptor().face_sizes)?, refiner.num_levels()?);
        let (actual, needed) = (refiner.scheme()?, scheme.opensubdiv(kind));
        if actual != needed {
            return Err(HierarchyError::OtherScheme { actual, needed });
        }
        budget::check(&cage, kind, levels)?;
        Self::read(cage, scheme, kind, refiner, levels, |_| ())
    }

    fn read(
        cage: Cage,
        scheme: Scheme,
        kind: SplitKind,
        refiner: &Refiner,
        levels: usize,
        mut progress: impl FnMut(usize),
    ) -> Result<Self, HierarchyError> {
        let cage_level = Level::cage(refiner.mesh(0)?, refiner.tag_lists(0)?);
        let mut hierarchy =
            Hierarchy { cage, scheme, kind, levels: vec![cage_level], refinements: Vec::new() };
        progress(0);
        for l in 1..=levels {
            let parent = hierarchy.finest().shared_mesh().clone();
            let split = Split::new(kind, &parent);
            if !refiner.numbers_children_as(l - 1, kind)? {
                return Err(HierarchyError::UnknownNumbering { level: l });
            }
            let before = hierarchy.refinements.last().zip(hierarchy.finest().above());
            let known =
                before.map_or(Vec::new(), |(r, above)| scheme.regular_children(above, &r.split, &r.homotopy));
            let masks = refiner.masks_except(l - 1, &known)?;
            let homotopy = scheme.homotopy(kind, &parent, &masks, &known);
            let above = hierarchy.finest().above();
            let top = l.checked_sub(2).and_then(|l| hierarchy.level(l).above());
            let refinement = Refinement::new(&parent, [above, top], split, homotopy);
            hierarchy.refinements.push(Arc::new(refinement));
            hierarchy.levels.push(Level::refined(parent, split, refiner.tag_lists(l)?));
            progress(l);
        }
        Ok(hierarchy)
    }

    /// The cage, level 0 as it was handed in.
    pub fn cage(&self) -> &Cage {
        &self.cage
    }

    /// The scheme.
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// The way in which faces split.
    pub fn split_kind(&self) -> SplitKind {
        self.kind
    }

    /// The number of the finest level.
    pub fn num_levels(&self) -> usize {
        self.refinements.len()
    }

    /// Level `level`.
    ///
    /// # Panics
    /// If there is no such level.
    pub fn level(&self, level: usize) -> &Level {
        &self.levels[level]
    }

    /// The finest level.
    pub fn finest(&self) -> &Level {
        &self.levels[self.num_levels()]
    }

    /// The step from `level - 1` to `level`.
    ///
    /// # Panics
    /// If `level` is 0 or there is no such level.
    pub fn refinement(&self, level: usize) -> &Refinement {
        &self.refinements[level - 1]
    }

    /// Refines a cochain from `level - 1` to `level`, without storing `S0`, `S1` or `S2`.
    ///
    /// # Panics
    /// If `level` is 0 or there is no such level, or the cochain does not belong to `level - 1`.
    pub fn refine<const K: usize, T: Quantity>(
        &self,
        level: usize,
        cochain: &Cochain<K, T>,
    ) -> Cochain<K, T> {
        let mut refined = Cochain::new(Vec::new());
        self.refine_into(level, cochain, &mut refined, &mut Workspace::new());
        refined
    }

    /// [`Hierarchy::refine`] into a cochain whose memory is used again, whatever was in it. Fresh memory costs as
    /// much time as refining does.
    ///
    /// # Panics
    /// As [`Hierarchy::refine`].
    pub fn refine_into<const K: usize, T: Quantity>(
        &self,
        level: usize,
        cochain: &Cochain<K, T>,
        refined: &mut Cochain<K, T>,
        workspace: &mut Workspace<T>,
    ) {
        let parent = self.level(level - 1).mesh();
        self.refinement(level).apply_into(parent, cochain, refined.values_mut(), workspace);
    }

    /// Refines a cochain of the cage to the finest level.
    ///
    /// # Panics
    /// If the cochain does not belong to the cage.
    pub fn subdivide<const K: usize, T: Quantity>(&self, cochain: &Cochain<K, T>) -> Cochain<K, T> {
        let (mut from, mut to) = (cochain.clone(), Cochain::new(Vec::new()));
        let mut workspace = Workspace::new();
        for level in 1..=self.num_levels() {
            self.refine_into(level, &from, &mut to, &mut workspace);
            std::mem::swap(&mut from, &mut to);
        }
        from
    }

    /// The operators from `level - 1` to `level` as matrices.
    ///
    /// # Panics
    /// If `level` is 0 or there is no such level.
    pub fn operators(&self, level: usize) -> Operators {
        self.refinement(level).operators(self.level(level - 1).mesh())
    }
}

impl Hierarchy {
    /// One of the operators from `level - 1` to `level`: `S0`, `S1` or `S2`.
    ///
    /// # Panics
    /// If `degree > 2`, `level` is 0 or there is no such level.
    pub fn operator(&self, degree: usize, level: usize) -> Csr {
        let (refinement, parent) = (self.refinement(level), self.level(level - 1).mesh());
        match degree {
            0 => refinement.s0(parent),
            1 => refinement.s1(parent),
            2 => refinement.s2(parent),
            _ => panic!("a surface has no forms of degree {degree}"),
        }
    }

    /// The rows of one of the operators from `level - 1` to `level`, to be written where they are wanted: several times
    /// as fast as by way of a matrix, whose columns are in order.
    ///
    /// # Panics
    /// If `degree > 2`, `level` is 0 or there is no such level.
    pub fn step_stencils(&self, degree: usize, level: usize) -> StepStencils {
        assert!(degree <= 2, "a surface has no forms of degree {degree}");
        let parent = self.level(level - 1).shared_mesh().clone();
        StepStencils::new(self.refinements[level - 1].clone(), parent, degree)
    }

    /// The operator of one degree from level `from` straight to level `to`: the product of those between. Rows grow with
    /// the levels (on quads `S1` has 5, 11, 17, 22, .. entries a row, on triangles 9, 16, 20, ..), so refining
    /// level by level is cheaper unless one row is needed by itself.
    ///
    /// # Panics
    /// If `degree > 2`, `from >= to` or there is no such level.
    pub fn composed_operator(&self, degree: usize, from: usize, to: usize) -> Csr {
        assert!(from < to, "operators lead from a level to a later one");
        composed::operator(self, degree, [from, to])
    }

    /// [`Hierarchy::composed_operator`] from the cage to `level`, of each degree.
    ///
    /// # Panics
    /// If `level` is 0 or there is no such level.
    pub fn composed_operators(&self, level: usize) -> Operators {
        let composed = |degree| self.composed_operator(degree, 0, level);
        let (s1, (s0, s2)) = rayon::join(|| composed(1), || (composed(0), composed(2)));
        Operators { s0, s1, s2 }
    }
}

/// A refiner of `cage` with `levels` levels and the way it splits, once it is certain that the scheme
/// takes the cage and that the levels fit. The edges of the finest level are known if they are asked for.
pub(crate) fn refiner(
    cage: &Cage,
    scheme: Scheme,
    levels: usize,
    with_last_edges: bool,
) -> Result<(Refiner, SplitKind), HierarchyError> {
    let split = scheme.split(&cage.descriptor().face_sizes)?;
    budget::check(cage, split, levels)?;
    let mut refiner = Refiner::new(cage, scheme.opensubdiv(split))?;
    match (levels, with_last_edges) {
        (0, _) => {}
        (_, true) => refiner.refine_uniform(levels)?,
        (_, false) => refiner.refine_uniform_without_last_edges(levels)?,
    }
    Ok((refiner, split))
}
