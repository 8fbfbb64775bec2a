//! A hierarchy behind a handle, and what its schemes and options are called in numbers.

use std::sync::OnceLock;

use formwork::hierarchy::Hierarchy;
use formwork::limit::{Limit, LimitTangents};
use formwork::osd::{OsdScheme, Refiner};
use formwork::scheme::{BoundaryRule, DooSabin, Scheme, Variant};
use formwork::topology::{BoundaryInterpolation, Cage, CreasingMethod, Descriptor, TriangleSubdivision};

use crate::error::Invalid;

/// OpenSubdiv's `SCHEME_BILINEAR`: the lowest-order forms.
pub const FORMWORK_SCHEME_BILINEAR: u32 = 0;
/// OpenSubdiv's `SCHEME_CATMARK`, with Doo-Sabin on faces.
pub const FORMWORK_SCHEME_CATMARK: u32 = 1;
/// OpenSubdiv's `SCHEME_LOOP`, with half-box splines on faces. Triangles only.
pub const FORMWORK_SCHEME_LOOP: u32 = 2;
/// Loop with the subdominant eigenvalue 1/2 at every smooth vertex; not in OpenSubdiv. Triangles only.
pub const FORMWORK_SCHEME_MODIFIED_LOOP: u32 = 3;
/// The lowest-order forms of the split, all triangles or all quads.
pub const FORMWORK_SCHEME_WHITNEY: u32 = 4;

/// Catmull and Clark's weights on faces at irregular vertices, as in Wang's thesis.
pub const FORMWORK_DOO_SABIN_THESIS: u32 = 0;
/// Doo and Sabin's own.
pub const FORMWORK_DOO_SABIN_ORIGINAL: u32 = 1;

/// Loop's schemes at boundaries and creases: faces reflected evenly.
pub const FORMWORK_HALF_BOX_REFLECT: u32 = 0;
/// Appendix B of Wang's thesis.
pub const FORMWORK_HALF_BOX_THESIS: u32 = 1;
/// A cosine transform, which dies out fastest along the boundary.
pub const FORMWORK_HALF_BOX_DCT: u32 = 2;

/// What forms do where OpenSubdiv leaves a choice; all zero is the default.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct FormworkOptions {
    /// `FORMWORK_DOO_SABIN_THESIS` or `_ORIGINAL`: the faces of Catmull-Clark.
    pub doo_sabin: u32,
    /// `FORMWORK_HALF_BOX_REFLECT`, `_THESIS` or `_DCT`: the faces of Loop's schemes at boundaries and creases.
    pub half_box: u32,
}

impl FormworkOptions {
    fn scheme(self, scheme: u32) -> Result<Scheme, Invalid> {
        let choose = |what: &str, from: &[Scheme], number: u32| {
            let chosen = from.get(number as usize).copied();
            chosen.ok_or_else(|| Invalid(format!("{what} is {number}: use 0 to {}", from.len() - 1)))
        };
        let catmark = [DooSabin::Thesis, DooSabin::Original].map(Scheme::Catmark);
        let half_box = |variant| {
            [BoundaryRule::Reflect, BoundaryRule::Thesis, BoundaryRule::Dct]
                .map(|rule| Scheme::Loop(variant, rule))
        };
        let (catmark, plain, modified) = (
            choose("doo_sabin", &catmark, self.doo_sabin)?,
            choose("half_box", &half_box(Variant::Loop), self.half_box)?,
            choose("half_box", &half_box(Variant::ModifiedLoop), self.half_box)?,
        );
        choose("the scheme", &[Scheme::Bilinear, catmark, plain, modified, Scheme::Whitney], scheme)
    }
}

/// A refined mesh with its operators.
pub struct FormworkHierarchy {
    levels: Hierarchy,
    /// The limits of each level, once they have been asked for.
    limits: Vec<OnceLock<(Limit, LimitTangents)>>,
}

impl FormworkHierarchy {
    fn new(levels: Hierarchy) -> Self {
        let limits = (0..=levels.num_levels()).map(|_| OnceLock::new()).collect();
        FormworkHierarchy { levels, limits }
    }

    /// The levels.
    pub fn levels(&self) -> &Hierarchy {
        &self.levels
    }

    /// The limit of a level. Several tables need it, and it takes longer than any of them.
    pub fn limit(&self, level: usize) -> Result<&(Limit, LimitTangents), Invalid> {
        if let Some(known) = self.limits[level].get() {
            return Ok(known);
        }
        let found = Limit::with_tangents(&self.levels, level)?;
        Ok(self.limits[level].get_or_init(|| found))
    }

    /// Of a refiner that OpenSubdiv refined, by the forms that go with its scheme.
    pub fn of_refiner(refiner: &Refiner, options: FormworkOptions) -> Result<Self, Invalid> {
        let scheme = match refiner.scheme()? {
            OsdScheme::Bilinear => FORMWORK_SCHEME_BILINEAR,
            OsdScheme::Catmark => FORMWORK_SCHEME_CATMARK,
            OsdScheme::Loop => FORMWORK_SCHEME_LOOP,
        };
        Ok(Self::new(Hierarchy::from_refiner(refiner, options.scheme(scheme)?)?))
    }

    /// Of a cage.
    pub fn of_cage(
        descriptor: Descriptor,
        scheme: u32,
        options: FormworkOptions,
        levels: i32,
    ) -> Result<Self, Invalid> {
        let (cage, scheme) = (Cage::new(descriptor)?, options.scheme(scheme)?);
        let levels =
            usize::try_from(levels).map_err(|_| Invalid(format!("{levels} levels: use 0 or more")))?;
        Ok(Self::new(Hierarchy::new(&cage, scheme, levels)?))
    }

    /// `level`, if there is such a level.
    pub fn level(&self, level: i32) -> Result<usize, Invalid> {
        let finest = self.levels.num_levels();
        let found = usize::try_from(level).ok().filter(|&level| level <= finest);
        found.ok_or_else(|| Invalid(format!("there is no level {level}: the finest is {finest}")))
    }
}

/// The options of OpenSubdiv, by its own numbers.
pub fn opensubdivs(
    boundary: u32,
    creasing: u32,
    triangles: u32,
) -> Result<(BoundaryInterpolation, CreasingMethod, TriangleSubdivision), Invalid> {
    fn choose<T: Copy>(what: &str, from: &[T], number: u32) -> Result<T, Invalid> {
        let chosen = from.get(number as usize).copied();
        chosen.ok_or_else(|| Invalid(format!("{what} is {number}: use 0 to {}", from.len() - 1)))
    }
    use BoundaryInterpolation as B;
    Ok((
        choose("boundary", &[B::None, B::EdgeOnly, B::EdgeAndCorner], boundary)?,
        choose("creasing", &[CreasingMethod::Uniform, CreasingMethod::Chaikin], creasing)?,
        choose("triangles", &[TriangleSubdivision::Catmark, TriangleSubdivision::Smooth], triangles)?,
    ))
}
