//! Where lengths and angles are measured.

use std::fmt;
use std::sync::Arc;

use crate::limit::Taylor;

type Map = Arc<dyn Fn([Taylor; 3]) -> [Taylor; 3] + Send + Sync>;
type Tensor = Arc<dyn Fn([Taylor; 2]) -> [Taylor; 3] + Send + Sync>;
type Given = Arc<dyn Fn(u32, [Taylor; 2]) -> [Taylor; 3] + Send + Sync>;

/// A metric on a limit surface. All kinds are functions of Taylor polynomials, so that a function that is written down
/// once has the derivatives that codifferentials need.
///
/// ```
/// use formwork::fem::Metric;
/// use formwork::limit::Taylor;
///
/// // The unit sphere, by pushing the surface onto it.
/// let sphere = Metric::mapped(|p| {
///     let r = (p[0] * p[0] + p[1] * p[1] + p[2] * p[2]).sqrt();
///     p.map(|x| x / r)
/// });
/// // A torus of revolution over a chart of its two angles: g_11, g_12, g_22.
/// let torus = Metric::chart(|[_, v]| {
///     let r = v.cos() * 0.4 + Taylor::constant(1.0);
///     [r * r, Taylor::constant(0.0), Taylor::constant(0.16)]
/// });
/// ```
#[derive(Clone, Default)]
pub enum Metric {
    /// That of the limit surface in space. Of a flat cage it is the plane's.
    #[default]
    Surface,
    /// That of the image of the limit surface under a map of space.
    Mapped(Map),
    /// A tensor field `g_11`, `g_12`, `g_22` of the first two coordinates of the limit surface, which is a chart.
    Chart(Tensor),
    /// A tensor field `g_ss`, `g_st`, `g_tt` in the parameters of each face of the finest level, by number of the face
    /// and the parameters from its own origin ([`LimitSurface::face_origin`](crate::limit::LimitSurface::face_origin)).
    Given(Given),
}

impl fmt::Debug for Metric {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Metric::Surface => "Surface",
            Metric::Mapped(_) => "Mapped",
            Metric::Chart(_) => "Chart",
            Metric::Given(_) => "Given",
        })
    }
}

impl Metric {
    /// [`Metric::Mapped`].
    pub fn mapped(map: impl Fn([Taylor; 3]) -> [Taylor; 3] + Send + Sync + 'static) -> Self {
        Metric::Mapped(Arc::new(map))
    }

    /// [`Metric::Chart`].
    pub fn chart(tensor: impl Fn([Taylor; 2]) -> [Taylor; 3] + Send + Sync + 'static) -> Self {
        Metric::Chart(Arc::new(tensor))
    }

    /// [`Metric::Given`].
    pub fn given(tensor: impl Fn(u32, [Taylor; 2]) -> [Taylor; 3] + Send + Sync + 'static) -> Self {
        Metric::Given(Arc::new(tensor))
    }

    /// `g_ss`, `g_st`, `g_tt` in the parameters of a face, of an order less than that of the position there.
    pub(super) fn tensor(&self, face: u32, at: [f64; 2], position: [Taylor; 3]) -> [Taylor; 3] {
        let first = |x: &[Taylor]| {
            let by = |k: usize| x.iter().map(move |x| x.by(k));
            let dot = |a: usize, b: usize| {
                by(a).zip(by(b)).map(|(x, y)| x * y).reduce(|x, y| x + y).expect("coordinates")
            };
            [dot(0, 0), dot(0, 1), dot(1, 1)]
        };
        match self {
            Metric::Surface => first(&position),
            Metric::Mapped(map) => first(&map(position)),
            Metric::Chart(tensor) => {
                let [x, y, _] = position;
                let [a, b, c] = tensor([x, y]);
                let pulled = |k: usize, l: usize| {
                    let (xk, yk, xl, yl) = (x.by(k), y.by(k), x.by(l), y.by(l));
                    a * xk * xl + b * (xk * yl + yk * xl) + c * yk * yl
                };
                [pulled(0, 0), pulled(0, 1), pulled(1, 1)]
            }
            Metric::Given(tensor) => {
                let order = position[0].order() - 1;
                tensor(face, Taylor::variables(at, order)).map(|x| x.truncated(order))
            }
        }
    }
}

/// Where the tangents are nearer to parallel than this (the sine between them), a point counts nothing.
pub(super) const DEGENERATE: f64 = 1e-10;

/// What a metric makes of a point in the parameters of a face. All operators are those of forms, in any metric:
///
/// ```text
/// *w = (-(B w_s + C w_t), A w_s + B w_t)       A, B, C = sqrt(g) g^ss, sqrt(g) g^st, sqrt(g) g^tt
/// *dw = (d_s w_t - d_t w_s) / sqrt(g)          delta w = -d*w / sqrt(g) = -(d_s (A w_s + B w_t) + d_t (B w_s + C w_t)) / sqrt(g)
/// ```
///
/// Thesis (5.14), (5.15), not expanded.
#[derive(Clone, Copy, Debug)]
pub struct Geometry {
    /// `sqrt(g)`.
    pub area: Taylor,
    /// `1 / sqrt(g)`.
    pub density: Taylor,
    /// `sqrt(g) g^ss`, `sqrt(g) g^st`, `sqrt(g) g^tt`.
    pub conjugate: [Taylor; 3],
}

impl Geometry {
    /// Of a tensor `g_ss`, `g_st`, `g_tt`; `None` where it is degenerate.
    pub fn new([a, b, c]: [Taylor; 3]) -> Option<Self> {
        let determinant = a * c - b * b;
        let least = DEGENERATE * DEGENERATE * a.value() * c.value();
        if determinant.value() <= least || !determinant.value().is_finite() {
            return None;
        }
        let area = determinant.sqrt();
        let density = area.recip();
        Some(Geometry { area, density, conjugate: [c * density, -b * density, a * density] })
    }

    /// `*w`.
    pub fn star(&self, [x, y]: [Taylor; 2]) -> [Taylor; 2] {
        let [a, b, c] = self.conjugate;
        [-(b * x + c * y), a * x + b * y]
    }

    /// `*dw`, of an order less.
    pub fn curl(&self, [x, y]: [Taylor; 2]) -> Taylor {
        (y.by(0) - x.by(1)) * self.density
    }

    /// `delta w`, of an order less.
    pub fn codifferential(&self, w: [Taylor; 2]) -> Taylor {
        -self.curl(self.star(w))
    }

    /// `(d delta + delta d) w`, of two orders less: `delta d w = -*d *d w`.
    pub fn laplacian(&self, w: [Taylor; 2]) -> [Taylor; 2] {
        let (curl, s) = (self.curl(w), self.codifferential(w));
        let rotated = self.star(gradient(curl));
        [0, 1].map(|k| s.by(k) - rotated[k])
    }

    /// `delta d f` of a function, of two orders less.
    pub fn laplacian0(&self, f: Taylor) -> Taylor {
        self.codifferential(gradient(f))
    }
}

/// `df`.
pub fn gradient(f: Taylor) -> [Taylor; 2] {
    [f.by(0), f.by(1)]
}
