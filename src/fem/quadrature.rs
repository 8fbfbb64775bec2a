//! Rules of integration on the unit square and the unit triangle.

use crate::limit::QuadratureRule;
use crate::topology::SplitKind;

/// How integrals over a face are taken: [`LimitSurface::basis`](crate::limit::LimitSurface::basis) says what the
/// rules of each depth are for.
///
/// The default integrates products of the smooth forms exactly on a regular flat face: 4 x 4 Gauss points on a quad,
/// 16 points of degree 8 on a triangle. Next to irregular vertices and features it splits seven times, with fewer points
/// from the third split on, where parts weigh a 64th and less.
#[derive(Clone, Debug, PartialEq)]
pub struct Quadrature {
    rules: Vec<QuadratureRule>,
}

impl Quadrature {
    /// The default for a way of splitting faces.
    pub fn new(kind: SplitKind) -> Self {
        let [most, some, few] = match kind {
            SplitKind::Quad => [4, 3, 2].map(square),
            SplitKind::Triangle => [8, 6, 4].map(triangle),
        };
        let rules = [&most, &most, &some, &some, &few, &few, &few, &few].map(Clone::clone).to_vec();
        Quadrature { rules }
    }

    /// The rules by depth, the first for regular faces.
    ///
    /// # Panics
    /// If there are fewer than three: an irregular face has no regular part before it is split twice.
    pub fn graded(rules: Vec<QuadratureRule>) -> Self {
        assert!(rules.len() >= 3, "an irregular face wants rules for two splits and more");
        Quadrature { rules }
    }

    /// The rules by depth.
    pub fn rules(&self) -> &[QuadratureRule] {
        &self.rules
    }
}

/// Gauss' rule with `n` points on `[0, 1]`, exact to degree `2n - 1`: the roots of Legendre's polynomial by Newton's
/// method.
pub fn gauss(n: usize) -> Vec<(f64, f64)> {
    let point = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..100 {
            let (mut before, mut p) = (1.0, x);
            for k in 2..=n {
                (before, p) = (p, ((2 * k - 1) as f64 * x * p - (k - 1) as f64 * before) / k as f64);
            }
            slope = n as f64 * (x * p - before) / (x * x - 1.0);
            let step = p / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        (0.5 - x / 2.0, 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(point).collect()
}

/// Gauss' rule with `n * n` points on the unit square.
pub fn square(n: usize) -> QuadratureRule {
    let line = gauss(n);
    line.iter().flat_map(|&(t, b)| line.iter().map(move |&(s, a)| ([s, t], a * b))).collect()
}

/// A symmetric rule on the triangle `s, t >= 0`, `s + t <= 1`, exact to degree 4 (6 points), 6 (12) or 8 (16): D. A.
/// Dunavant, "High degree efficient symmetrical Gaussian quadrature rules for the triangle", 1985.
///
/// # Panics
/// For another degree.
pub fn triangle(degree: usize) -> QuadratureRule {
    // The weight, and the barycentric coordinates whose permutations are the points.
    let orbits: &[(f64, [f64; 2])] = match degree {
        4 => &[(0.223381589678011, [0.445948490915965; 2]), (0.109951743655322, [0.091576213509771; 2])],
        6 => &[
            (0.116786275726379, [0.249286745170910; 2]),
            (0.050844906370207, [0.063089014491502; 2]),
            (0.082851075618374, [0.053145049844817, 0.310352451033784]),
        ],
        8 => &[
            (0.144315607677787, [1.0 / 3.0; 2]),
            (0.095091634267285, [0.459292588292723; 2]),
            (0.103217370534718, [0.170569307751760; 2]),
            (0.032458497623198, [0.050547228317031; 2]),
            (0.027230314174435, [0.008394777409958, 0.263112829634638]),
        ],
        _ => panic!("there is no rule of degree {degree}"),
    };
    let mut rule = Vec::new();
    for &(weight, [a, b]) in orbits {
        let c = 1.0 - a - b;
        let points = match (a == b, b == c) {
            _ if (a - b).abs() + (b - c).abs() < 1e-12 => vec![[a, b]],
            (true, _) => vec![[a, a], [a, c], [c, a]],
            _ => vec![[a, b], [b, a], [a, c], [c, a], [b, c], [c, b]],
        };
        rule.extend(points.into_iter().map(|point| (point, weight / 2.0)));
    }
    rule
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_exact_to_their_degree() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for n in 1..=6i32 {
            for i in 0..2 * n {
                let sum: f64 = gauss(n as usize).iter().map(|(x, w)| w * x.powi(i)).sum();
                assert!((sum - 1.0 / f64::from(i + 1)).abs() < 1e-14, "{n} points, x^{i}");
            }
        }
        for degree in [4, 6, 8] {
            for i in 0..=degree {
                for j in 0..=degree - i {
                    let rule = triangle(degree as usize);
                    let sum: f64 = rule.iter().map(|([s, t], w)| w * s.powi(i) * t.powi(j)).sum();
                    let exact = factorial(i) * factorial(j) / factorial(i + j + 2);
                    assert!((sum - exact).abs() < 1e-14, "degree {degree}, s^{i} t^{j}: {}", sum - exact);
                }
            }
        }
    }
}
