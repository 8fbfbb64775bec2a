use super::FemError;
use super::complex::HilbertComplex;
use super::resolvent::Resolvent;

/// Diffusion of forms, `dw/dt = -Delta w`: heat for functions and densities, vector diffusion for 1-forms. One factorisation
/// serves every step of one length.
///
/// With `R = (1 + theta step Delta)^-1`, a step is `w + (R w - w) / theta`: implicit Euler for `theta = 1`,
/// Crank-Nicolson for `theta = 1/2`. Harmonic forms are fixed, and integrals of functions and densities are kept (to
/// rounding) where the boundary is natural.
pub struct Diffusion<'a> {
    resolvent: Resolvent<'a>,
    step: f64,
    theta: f64,
}

/// The rule of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeRule {
    /// First order; damps what is rough.
    #[default]
    Euler,
    /// Second order; rough data rings.
    CrankNicolson,
}

impl<'a> Diffusion<'a> {
    /// Factorises for steps of a length, in units of length^2.
    ///
    /// # Errors
    /// If a mass is singular.
    ///
    /// # Panics
    /// If `degree > 2` or the step is not positive.
    pub fn new(
        complex: &'a HilbertComplex,
        degree: usize,
        step: f64,
        rule: TimeRule,
    ) -> Result<Self, FemError> {
        assert!(step > 0.0 && step.is_finite(), "a step wants a positive length, not {step}");
        let theta = if rule == TimeRule::Euler { 1.0 } else { 0.5 };
        let resolvent = Resolvent::new(complex, degree, 1.0 / (theta * step))?;
        Ok(Diffusion { resolvent, step, theta })
    }

    /// The length of a step.
    pub fn step_length(&self) -> f64 {
        self.step
    }

    /// The resolvent that does the work.
    pub fn resolvent(&self) -> &Resolvent<'a> {
        &self.resolvent
    }

    /// Takes one step.
    ///
    /// # Panics
    /// If the form is one of another complex.
    pub fn step(&self, w: &mut [f64]) {
        let t = &self.resolvent;
        assert_eq!(w.len(), t.complex().len(t.degree()), "a form of another complex");
        let [_, unit] = t.units();
        let shift = t.shift() * unit;
        let pair = t.invert(&[t.weigh(w)]).swap_remove(0);
        for (x, y) in w.iter_mut().zip(&pair[t.below()..]) {
            *x += (shift * y - *x) / self.theta;
        }
    }
}
