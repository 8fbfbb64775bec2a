use super::FemError;
use super::complex::HilbertComplex;
use super::pcg::conjugate_gradients;
use super::resolvent::Resolvent;
use super::stiffness;
use crate::sparse::{apply, inner};

/// The Hodge Laplacian of a degree, to be solved: `Delta w = f - P f`, with `P` the projection onto the harmonic forms
/// and `w` orthogonal to them.
///
/// Source: the mixed formulation of Arnold, Falk, Winther, 2010, section 3. Its matrix is singular where there are harmonic
/// forms, so it is never factorised: `w` solves `(1 - s T) w = T f` with the resolvent `T = (Delta + s)^-1`, whose
/// eigenvalues off the harmonic forms lie between `l / (l + s)`, `l` the lowest of the Laplacian, and 1; a few steps of
/// conjugate gradients in the inner product of the forms.
pub struct HodgeLaplace<'a> {
    resolvent: Resolvent<'a>,
    /// Orthonormal in units of the mesh, and their images by the mass.
    harmonic: Vec<[Vec<f64>; 2]>,
}

/// A solution of a Hodge-Laplace problem.
#[derive(Clone, Debug)]
pub struct Solution {
    /// `w`, as a cochain.
    pub form: Vec<f64>,
    /// `sigma = delta w`, as a cochain of one degree less; empty for functions.
    pub sigma: Vec<f64>,
    /// The coefficients of the data's harmonic part on [`HodgeLaplace::harmonic`]: 0 where the problem has a
    /// solution as it stands.
    pub defect: Vec<f64>,
    /// The steps that were taken.
    pub iterations: usize,
    /// The 2-norm of what is left over of both equations, relative to the right-hand side, entries in units of the mesh.
    pub residual: f64,
}

/// What conjugate gradients end at, and the steps they may take.
const CONVERGED: f64 = 1e-14;
const MOST: usize = 500;

/// The same of conjugate gradients without factors.
const ITERATED: f64 = 1e-12;
const MOST_ITERATED: usize = 20_000;

/// An eigenvalue is 0 below this part of the shift. Zeros come out near the square of the unit roundoff, and the shift is
/// below the lowest eigenvalue of any surface that is not drawn out to a thousand times its width.
const ZERO: f64 = 1e-9;

impl<'a> HodgeLaplace<'a> {
    /// Factorises, and finds the harmonic forms: as many as `d0` and `d1` say ([`HilbertComplex::betti`]).
    ///
    /// # Errors
    /// If a mass is singular, or the forms found are not harmonic.
    ///
    /// # Panics
    /// If `degree > 2`.
    pub fn new(complex: &'a HilbertComplex, degree: usize) -> Result<Self, FemError> {
        let expected = complex.betti()?[degree];
        let resolvent = Resolvent::new(complex, degree, Resolvent::natural_shift(complex))?;
        let spectrum = resolvent.lowest(expected)?;
        let found = spectrum.values.iter().filter(|value| **value < ZERO * resolvent.shift()).count();
        if found != expected {
            return Err(FemError::Harmonic { degree, expected, found });
        }
        let weigh = |mut h: Vec<f64>| {
            let size = inner(&h, &resolvent.weigh(&h)).sqrt();
            h.iter_mut().for_each(|x| *x /= size);
            let weighed = resolvent.weigh(&h);
            [h, weighed]
        };
        let harmonic = spectrum.forms.into_iter().map(weigh).collect();
        Ok(HodgeLaplace { resolvent, harmonic })
    }

    /// The resolvent that does the work.
    pub fn resolvent(&self) -> &Resolvent<'a> {
        &self.resolvent
    }

    /// An orthonormal basis of the harmonic forms.
    pub fn harmonic(&self) -> Vec<Vec<f64>> {
        let [_, unit] = self.resolvent.units();
        // <h, h> in units of the mesh is unit^(k - 1) times that in those of the caller.
        let scale = unit.powi(self.resolvent.degree() as i32 - 1).sqrt();
        self.harmonic.iter().map(|[h, _]| h.iter().map(|x| x * scale).collect()).collect()
    }

    /// Takes the harmonic part off a form.
    fn remove_harmonic(&self, w: &mut [f64]) {
        for [h, weighed] in &self.harmonic {
            let c = inner(weighed, w);
            w.iter_mut().zip(h).for_each(|(x, y)| *x -= c * y);
        }
    }

    /// Solves for the load `<f, v>` of every basis form `v`. `natural`, if there is any, is what boundary data adds to the
    /// equation of `sigma`, `<sigma, t> - <w, d t> = natural(t)` for every basis form `t` of one degree less.
    ///
    /// # Errors
    /// [`FemError::NoConvergence`].
    ///
    /// # Panics
    /// If a right-hand side is of another length.
    pub fn solve(&self, load: &[f64], natural: Option<&[f64]>) -> Result<Solution, FemError> {
        let t = &self.resolvent;
        let (below, n) = (t.below(), t.complex().len(t.degree()));
        assert_eq!(load.len(), n, "a load of another complex");
        assert!(natural.is_none_or(|g| g.len() == below), "natural data of another complex");
        let [of_load, unit] = t.units();
        let mut right = vec![0.0; below];
        if let Some(natural) = natural {
            right.iter_mut().zip(natural).for_each(|(x, y)| *x = -y * of_load / unit);
        }
        right.extend(load.iter().map(|x| x * of_load));
        let mut defect = Vec::new();
        for [h, weighed] in &self.harmonic {
            let c = inner(h, &right[below..]);
            right[below..].iter_mut().zip(weighed).for_each(|(x, y)| *x -= c * y);
            defect.push(c / of_load * unit.powi(t.degree() as i32 - 1).sqrt());
        }
        let resolve = |right: Vec<f64>| {
            let mut pair = [right];
            t.solve_pairs(&mut pair);
            let [pair] = pair;
            pair
        };
        let shift = t.shift() * unit;
        let mut r = resolve(right.clone()).split_off(below);
        self.remove_harmonic(&mut r);
        let (mut w, mut p) = (vec![0.0; n], r.clone());
        let mut size = inner(&r, &t.weigh(&r));
        let (wanted, mut iterations) = (CONVERGED * CONVERGED * size, 0);
        while size > wanted {
            if iterations == MOST {
                return Err(FemError::NoConvergence { what: "a solution", iterations });
            }
            iterations += 1;
            let weighed = t.weigh(&p);
            let mut q = t.invert(std::slice::from_ref(&weighed)).swap_remove(0).split_off(below);
            q.iter_mut().zip(&p).for_each(|(q, p)| *q = p - shift * *q);
            self.remove_harmonic(&mut q);
            let step = size / inner(&weighed, &q);
            w.iter_mut().zip(&p).for_each(|(w, p)| *w += step * p);
            r.iter_mut().zip(&q).for_each(|(r, q)| *r -= step * q);
            let next = inner(&r, &t.weigh(&r));
            let ratio = next / size;
            p.iter_mut().zip(&r).for_each(|(p, r)| *p = r + ratio * *p);
            size = next;
        }
        // Once more with what was found on the right, which gives sigma.
        let weighed = t.weigh(&w);
        let mut full = right.clone();
        full[below..].iter_mut().zip(&weighed).for_each(|(x, y)| *x += shift * y);
        let mut pair = resolve(full);
        self.remove_harmonic(&mut pair[below..]);
        let left = t.residual(&pair, &right);
        let norm = |x: &[f64]| inner(x, x);
        let residual = ((norm(&left[0]) + norm(&left[1])) / norm(&right).max(f64::MIN_POSITIVE)).sqrt();
        let form = pair.split_off(below);
        pair.iter_mut().for_each(|x| *x /= unit);
        Ok(Solution { form, sigma: pair, defect, iterations, residual })
    }
}

/// Poisson's problem `Delta w = f - P f` of functions by [`conjugate_gradients`], for systems too large for factors, with the
/// load `<f, v>` of every basis function `v`: what [`HodgeLaplace::solve`] finds in degree 0, to a residual of 1e-12, and
/// the condition number of the system scaled to diagonal 1. Defects come one for each component without a boundary
/// condition.
///
/// # Errors
/// [`FemError::NoConvergence`]; [`FemError::NonManifold`] if an edge has more than two ends.
///
/// # Panics
/// If the load is of another length.
pub fn poisson(complex: &HilbertComplex, load: &[f64]) -> Result<(Solution, f64), FemError> {
    let (count, component) = complex.constants()?;
    let weights = apply(complex.mass(0), &vec![1.0; complex.len(0)]);
    let sums = |x: &[f64]| {
        let mut sums = vec![0.0; count];
        let of = component.iter().zip(x).filter_map(|(of, x)| of.map(|of| (of as usize, x)));
        of.for_each(|(of, x)| sums[of] += x);
        sums
    };
    let areas = sums(&weights);
    let mean = |of: Option<u32>, sums: &[f64]| of.map_or(0.0, |of| sums[of as usize] / areas[of as usize]);
    let loads = sums(load);
    let part = component.iter().zip(&weights).map(|(&of, weight)| weight * mean(of, &loads));
    let right: Vec<f64> = load.iter().zip(part).map(|(x, part)| x - part).collect();
    let matrix = stiffness(complex.mass(1), complex.d(0));
    let found = conjugate_gradients(&matrix, &right, ITERATED, MOST_ITERATED)?;
    let means = sums(&apply(complex.mass(0), &found.solution));
    let form = found.solution.iter().zip(&component).map(|(x, &of)| x - mean(of, &means)).collect();
    let defect = loads.iter().zip(&areas).map(|(load, area)| load / area.sqrt()).collect();
    let (iterations, residual) = (found.iterations, found.residual);
    Ok((Solution { form, sigma: Vec::new(), defect, iterations, residual }, found.condition))
}
