//! OpenSubdiv's own evaluation of limit surfaces.

use cxx::UniquePtr;

use super::bridge::ffi;
use super::{OsdError, Refiner};

/// The limit surface of a refiner's cage as OpenSubdiv's `Bfr` evaluates it: what formwork's evaluation is held
/// against, in accuracy and in time.
///
/// Next to irregular vertices and sharp features it is an approximation: they are refined to a level, and what is
/// left round an irregular vertex is closed by a patch.
pub struct Bfr<'a>(UniquePtr<ffi::Bfr<'a>>);

/// OpenSubdiv's default for the level to which irregular vertices are refined.
pub const BFR_SMOOTH_LEVEL: u8 = 2;

/// OpenSubdiv's default for the level to which sharp features are refined.
pub const BFR_SHARP_LEVEL: u8 = 6;

impl Refiner {
    /// `Bfr` on the cage, refining irregular vertices to `smooth_level` and sharp features to `sharp_level`.
    ///
    /// # Errors
    /// If a level is 0 or above 15.
    pub fn bfr(&self, smooth_level: u8, sharp_level: u8) -> Result<Bfr<'_>, OsdError> {
        Ok(Bfr(ffi::new_bfr(&self.0, smooth_level, sharp_level)?))
    }
}

impl Bfr<'_> {
    /// Positions and their derivatives by `u` and `v` at points `(u, v)` of faces, `positions` having 3 numbers for
    /// each vertex of the cage. The parameters are `Bfr`'s: on a quad, and on a triangle of Loop's scheme, `(0, 0)`
    /// is the first corner, `(1, 0)` the second and `(0, 1)` the last.
    ///
    /// The surface of a face is set up once for each run of points in it.
    ///
    /// # Errors
    /// If the lengths do not match, there is no such face, a face has no limit surface, as holes and faces at
    /// boundaries that are not interpolated have none, or a point is outside its face.
    pub fn evaluate(
        &self,
        positions: &[f64],
        faces: &[u32],
        uv: &[[f64; 2]],
    ) -> Result<Vec<[[f64; 3]; 3]>, OsdError> {
        let mut out = vec![[[0.0; 3]; 3]; faces.len()];
        let flat = out.as_flattened_mut().as_flattened_mut();
        self.0.evaluate(positions, faces, uv.as_flattened(), true, flat)?;
        Ok(out)
    }

    /// [`Bfr::evaluate`] without the derivatives.
    ///
    /// # Errors
    /// Likewise.
    pub fn evaluate_positions(
        &self,
        positions: &[f64],
        faces: &[u32],
        uv: &[[f64; 2]],
    ) -> Result<Vec<[f64; 3]>, OsdError> {
        let mut out = vec![[0.0; 3]; faces.len()];
        self.0.evaluate(positions, faces, uv.as_flattened(), false, out.as_flattened_mut())?;
        Ok(out)
    }
}
