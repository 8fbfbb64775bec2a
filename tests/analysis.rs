//! Spectra and characteristic maps against closed forms: Catmull-Clark (Doo and Sabin 1978, Ball and Storry 1988), Loop
//! 1987, and (4.1) and Lemma 3.32 of Ke Wang's thesis.

use std::f64::consts::TAU;

use formwork::analysis::{AnalysisError, CharacteristicMap, Eigenvalue, Ring, Spectrum, Symmetry};
use formwork::limit::SurfacePoint;
use formwork::nalgebra::DMatrix;
use formwork::scheme::{BoundaryRule, DooSabin, Scheme, Variant};
use formwork::topology::SplitKind;

/// Eigenvalues, compared to rounding. Blocks of a few rows have an eigenvalue that is as good as their entries.
const ROUNDING: f64 = 1e-13;

const CATMARK: Scheme = Scheme::Catmark(DooSabin::Thesis);
const DOO_SABIN: Scheme = Scheme::Catmark(DooSabin::Original);
const LOOP: Scheme = Scheme::Loop(Variant::Loop, BoundaryRule::Reflect);
const MODIFIED: Scheme = Scheme::Loop(Variant::ModifiedLoop, BoundaryRule::Reflect);
const ALL: [Scheme; 6] = [CATMARK, DOO_SABIN, LOOP, MODIFIED, Scheme::Bilinear, Scheme::Whitney];

fn ring(scheme: Scheme, k: usize, boundary: bool) -> Ring {
    Ring::new(scheme, k, boundary, 2).unwrap()
}

/// All eigenvalues, each as often as it occurs, ascending; they are real.
fn sorted<'a>(values: impl IntoIterator<Item = &'a Eigenvalue>) -> Vec<f64> {
    let mut all = Vec::new();
    for e in values {
        assert!(e.value.im.abs() < ROUNDING, "{e:?}");
        assert!(e.eigenvectors >= 1 && e.eigenvectors <= e.multiplicity, "{e:?}");
        all.extend(vec![e.value.re; e.multiplicity]);
    }
    all.sort_by(f64::total_cmp);
    all
}

#[track_caller]
fn assert_same(found: &[f64], expected: Vec<f64>, what: &str) {
    let mut expected = expected;
    expected.sort_by(f64::total_cmp);
    assert_eq!(found.len(), expected.len(), "{what}");
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() < ROUNDING, "{what}: {found:?} {expected:?}");
    }
}

fn roots(sum: f64, product: f64) -> [f64; 2] {
    let root = (sum * sum / 4.0 - product).sqrt();
    [sum / 2.0 + root, sum / 2.0 - root]
}

fn cosine(m: usize, k: usize) -> f64 {
    (TAU * m as f64 / k as f64).cos()
}

/// `S0`: `(5 + c +- sqrt((c + 9)(c + 1)))/16` with `c = cos(2 pi m / k)` for each mode but 0.
fn catmark_vertices(k: usize) -> Vec<f64> {
    let n = k as f64;
    let mut all = vec![1.0];
    all.extend(roots(0.75 - 1.75 / n, (n - 3.0) / (16.0 * n)));
    for m in 1..k {
        let c = cosine(m, k);
        let root = ((c + 9.0) * (c + 1.0)).max(0.0).sqrt();
        all.extend([(5.0 + c + root) / 16.0, (5.0 + c - root) / 16.0]);
    }
    (0..k).for_each(|_| all.extend([1.0 / 8.0, 1.0 / 16.0, 1.0 / 32.0, 1.0 / 64.0]));
    all
}

/// `S2`: the eigenvalues of the face weights, a quarter of them, and the outer ring's.
fn doo_sabin_faces(weights: DooSabin, k: usize) -> Vec<f64> {
    let own = (0..k).map(|m| match (weights, m) {
        (_, 0) => 1.0,
        (DooSabin::Thesis, m) => 0.5 + cosine(m, k) / 4.0,
        (DooSabin::Original, m) if m == 1 || m + 1 == k => 0.5,
        (DooSabin::Original, _) => 0.25,
    });
    let outer = vec![[1.0 / 16.0, 1.0 / 32.0, 1.0 / 64.0]; k].concat();
    own.map(|x| x / 4.0).chain(outer).collect()
}

#[test]
fn catmull_clark_has_its_closed_forms() {
    for k in 3..=12 {
        for (scheme, weights) in [(CATMARK, DooSabin::Thesis), (DOO_SABIN, DooSabin::Original)] {
            let spectrum = Spectrum::new(&ring(scheme, k, false)).unwrap();
            assert_same(&sorted(&spectrum.s0), catmark_vertices(k), &format!("S0, {k}"));
            assert_same(&sorted(&spectrum.s2), doo_sabin_faces(weights, k), &format!("S2, {k} {weights:?}"));
            let subdominant = spectrum.subdominant().unwrap();
            assert_eq!((subdominant.symmetry, subdominant.multiplicity), (Symmetry::Mode(1), 2));
        }
    }
}

/// `3/8 + cos(2 pi m / k)/4 + eps`, which modified Loop makes 1/2 for `m = 1`, and `4 S2` as (4.1) says.
#[test]
fn loop_and_modified_loop_have_their_closed_forms() {
    for k in 3..=12 {
        for (scheme, eps) in [(LOOP, 0.0), (MODIFIED, 0.125 - cosine(1, k) / 4.0)] {
            let ring = ring(scheme, k, false);
            let spectrum = Spectrum::new(&ring).unwrap();
            // OpenSubdiv's weight comes from a cosine in single precision; the rest follows from it.
            let a = ring.operator(0)[(0, 1)];
            let modes = (1..k).map(|m| 0.375 + cosine(m, k) / 4.0 + eps);
            let outer = vec![[1.0 / 8.0, 1.0 / 16.0]; k].concat();
            let expected = [1.0, 0.625 + eps - k as f64 * a].into_iter().chain(modes).chain(outer);
            assert_same(&sorted(&spectrum.s0), expected.collect(), &format!("S0, {k} {scheme:?}"));

            let beta = |m: usize| if (k, m) == (6, 3) { 0.5 } else { 0.5f64.powi(m.min(k - m) as i32) };
            let outer = vec![[0.25, 0.125, 0.125]; k].concat();
            let expected = (0..k).map(beta).chain(outer).map(|x| x / 4.0).collect();
            assert_same(&sorted(&spectrum.s2), expected, &format!("S2, {k}"));

            if scheme == MODIFIED {
                let subdominant = spectrum.subdominant().unwrap();
                assert!((subdominant.value.re - 0.5).abs() < 1e-15, "{k}: {subdominant:?}");
                assert_eq!((subdominant.symmetry, subdominant.multiplicity), (Symmetry::Mode(1), 2));
                assert!((a - (3.0 + 8.0 * eps) / (8.0 * k as f64)).abs() < 1e-15);
            }
        }
    }
}

/// Lemma 3.32, in two ways: the eigenvalues of `S1`, found by themselves, are all matched; and the traces of powers, which are
/// exact to rounding however defective the matrices are, add up.
#[test]
fn spectra_of_edges_are_those_of_vertices_and_faces() {
    for scheme in ALL {
        for (k, boundary) in (3..=12).map(|k| (k, false)).chain((1..=6).map(|k| (k, true))) {
            let ring = ring(scheme, k, boundary);
            let spectrum = Spectrum::new(&ring).unwrap();
            let [v, e, f] = [0, 1, 2].map(|d| ring.num_cells(d));
            assert_eq!(v + f, e + 1, "a disk");
            assert_eq!(spectrum.counts(), [v - 1, f, 0], "{scheme:?} {k} {boundary}");
            assert!(spectrum.mismatch < 1e-12, "{scheme:?} {k} {boundary}: {}", spectrum.mismatch);
            let traces = [0, 1, 2].map(|d| traces(ring.operator(d)));
            for (p, trace) in traces[1].iter().enumerate() {
                let sum = traces[0][p] - 1.0 + traces[2][p];
                assert!((trace - sum).abs() < ROUNDING, "{scheme:?} {k} {boundary}, power {p}");
            }
            // The blocks hold the whole matrix.
            for (d, all) in [
                sorted(&spectrum.s0),
                sorted(spectrum.s1.iter().map(|e| &e.eigenvalue)),
                sorted(&spectrum.s2),
            ]
            .iter()
            .enumerate()
            {
                for (p, trace) in traces[d].iter().enumerate() {
                    let sum: f64 = all.iter().map(|x| x.powi(p as i32 + 1)).sum();
                    assert!((trace - sum).abs() < 1e-11, "S{d} of {scheme:?} {k} {boundary}, power {p}");
                }
            }
        }
    }
}

fn traces(matrix: &DMatrix<f64>) -> Vec<f64> {
    let mut power = DMatrix::identity(matrix.nrows(), matrix.nrows());
    let next = |_| {
        power = &power * matrix;
        power.trace()
    };
    (0..8).map(next).collect()
}

/// A chain of two vectors is told from two eigenvectors.
#[test]
fn defective_eigenvalues_are_counted() {
    // Whitney's S0 takes ring 2 to rings 3 and 4, and these nowhere: at 0 there are chains.
    let ring = Ring::new(Scheme::Whitney, 6, false, 4).unwrap();
    let spectrum = Spectrum::new(&ring).unwrap();
    let halves: Vec<_> = spectrum.s0.iter().filter(|e| (e.value.re - 0.5).abs() < 1e-9).collect();
    assert_eq!(halves.iter().map(|e| e.multiplicity).sum::<usize>(), 6);
    assert!(halves.iter().all(|e| e.eigenvectors == e.multiplicity));
    for e in &spectrum.s0 {
        let value = e.value.re;
        let n = ring.num_cells(0);
        let shifted = ring.operator(0) - DMatrix::identity(n, n) * value;
        let same = spectrum.s0.iter().filter(|other| (other.value.re - value).abs() < 1e-6);
        let eigenvectors: usize = same.map(|e| e.eigenvectors).sum();
        assert_eq!(eigenvectors, n - shifted.rank(1e-9), "{value}");
    }
    assert!(spectrum.s0.iter().any(|e| e.eigenvectors < e.multiplicity), "0 has chains");
}

/// Refined once, the characteristic map is itself scaled by its eigenvalues: `chi(s/2, t/2) = lambda chi(s, t)`.
#[test]
fn characteristic_maps_scale() {
    for scheme in [CATMARK, LOOP, MODIFIED] {
        for (k, boundary) in [(3, false), (5, false), (8, false), (2, true), (3, true), (5, true)] {
            let map = CharacteristicMap::new(ring(scheme, k, boundary)).unwrap();
            let [a, b] = map.eigenvalues();
            if scheme == MODIFIED {
                assert!((a - 0.5).abs() < 1e-14 && (b - 0.5).abs() < 1e-14, "{k} {boundary}: {a} {b}");
            }
            for face in 0..k as u32 {
                let points = [(0.9, 0.1), (0.5, 0.5), (0.0, 1.0), (0.3, 0.55)];
                let at = |scale: f64| {
                    points.map(|(s, t)| SurfacePoint { face, corner: 0, s: s * scale, t: t * scale })
                };
                let (whole, half) = (map.evaluate(&at(1.0)).unwrap(), map.evaluate(&at(0.5)).unwrap());
                for (p, q) in whole.iter().zip(&half) {
                    assert!((q.value.x - a * p.value.x).abs() < 1e-12, "{scheme:?} {k} {boundary}");
                    assert!((q.value.y - b * p.value.y).abs() < 1e-12, "{scheme:?} {k} {boundary}");
                }
            }
        }
    }
}

/// At regular vertices the characteristic map is the lattice.
#[test]
fn regular_characteristic_maps_are_affine() {
    let (half, root) = (0.5, 3f64.sqrt() / 2.0);
    for (scheme, k, boundary, b) in [
        (CATMARK, 4, false, [0.0, 1.0]),
        (CATMARK, 2, true, [0.0, 1.0]),
        (LOOP, 6, false, [half, root]),
        (MODIFIED, 6, false, [half, root]),
    ] {
        let map = CharacteristicMap::new(ring(scheme, k, boundary)).unwrap();
        let point = SurfacePoint { face: 0, corner: 0, s: 0.3, t: 0.45 };
        let jet = map.evaluate(&[point]).unwrap()[0];
        let expected = [0.3 + 0.45 * b[0], 0.45 * b[1]];
        assert!((jet.value.x - expected[0]).abs() < 1e-13, "{scheme:?} {jet:?}");
        assert!((jet.value.y - expected[1]).abs() < 1e-13, "{scheme:?} {jet:?}");
    }
}

/// Sampled: positive determinants everywhere and one turn, at valences 3 to 16.
#[test]
fn characteristic_maps_look_injective() {
    for scheme in [CATMARK, LOOP, MODIFIED] {
        for k in 3..=16 {
            let map = CharacteristicMap::new(ring(scheme, k, false)).unwrap();
            let found = map.regularity(24);
            let per_face = match map.ring().split_kind() {
                SplitKind::Quad => 25 * 25 - 12 * 12,
                SplitKind::Triangle => 25 * 26 / 2 - 12 * 13 / 2,
            };
            assert_eq!(found.samples, k * per_face);
            assert!(found.holds(), "{scheme:?} {k}: {found:?}");
        }
    }
    // Whitney's map is a fan of flat triangles.
    let flat = CharacteristicMap::new(ring(Scheme::Whitney, 3, false)).unwrap().regularity(8);
    assert!(flat.holds() && (flat.determinant[0] - flat.determinant[1]).abs() < 1e-13, "{flat:?}");
}

/// At boundary vertices modified Loop keeps 1/2, and OpenSubdiv's rules do not: with too many faces a wiggle that vanishes
/// on the crease outlives the crease itself, and the map folds it to a point.
#[test]
fn characteristic_maps_at_boundaries() {
    let map = |scheme, k| CharacteristicMap::new(ring(scheme, k, true));
    for k in 2..=8 {
        let modified = map(MODIFIED, k).unwrap().regularity(16);
        assert!(modified.holds(), "{k}: {modified:?}");
        let turn = map(LOOP, k).map(|map| map.regularity(16).holds()).ok();
        assert_eq!(turn, if k == 6 { None } else { Some(k < 6) }, "loop, {k}");
        let turn = map(CATMARK, k).map(|map| map.regularity(16).holds()).ok();
        assert_eq!(turn, if k == 4 { None } else { Some(k < 4) }, "catmark, {k}");
    }
    assert_eq!(map(CATMARK, 1).err(), Some(AnalysisError::NoCharacteristicMap));
}

/// Basis 1-forms in the chart: the differential of the basis function of a vertex is the signed sum of its edges' forms, and those
/// of all edges, weighted by how far they lead in x, are dx.
#[test]
fn basis_forms_on_the_chart() {
    for (scheme, k, boundary) in [(CATMARK, 5, false), (MODIFIED, 7, false), (LOOP, 4, true)] {
        let map = CharacteristicMap::new(Ring::new(scheme, k, boundary, 3).unwrap()).unwrap();
        let points: Vec<_> = (0..k as u32)
            .flat_map(|face| {
                [(0.3, 0.2), (0.6, 0.3), (0.1, 0.75)].map(|(s, t)| SurfacePoint { face, corner: 0, s, t })
            })
            .collect();
        let edges = map.ring().edges();
        let mut sum = vec![[0.0; 2]; points.len()];
        let mut star = vec![[0.0; 2]; points.len()];
        for (e, &[a, b]) in edges.iter().enumerate() {
            let along = map.control()[b as usize] - map.control()[a as usize];
            let samples = map.basis(1, e, &points).unwrap();
            for (i, sample) in samples.iter().enumerate() {
                for part in 0..2 {
                    sum[i][part] += along.x * sample.parts[part];
                    star[i][part] += f64::from(i8::from(b == 0) - i8::from(a == 0)) * sample.parts[part];
                }
            }
        }
        assert!(sum.iter().all(|p| (p[0] - 1.0).abs() < 1e-12 && p[1].abs() < 1e-12), "{sum:?}");
        // Differences of the 0-form, a small step along x and y in the parameters of the face.
        let step = 1e-5;
        for (i, &point) in points.iter().enumerate() {
            let moved = [[step, 0.0], [-step, 0.0], [0.0, step], [0.0, -step]].map(|[s, t]| SurfacePoint {
                s: point.s + s,
                t: point.t + t,
                ..point
            });
            let f = map.basis(0, 0, &moved).unwrap();
            for (p, q) in [(0, 1), (2, 3)] {
                let path = f[p].position - f[q].position;
                let expected = star[i][0] * path.x + star[i][1] * path.y;
                assert!((f[p].parts[0] - f[q].parts[0] - expected).abs() < 1e-9, "{scheme:?} {point:?}");
            }
        }
    }
}

#[test]
fn what_cannot_be_analysed_is_refused() {
    let error = |k, boundary, rings| Ring::new(CATMARK, k, boundary, rings).err().unwrap();
    assert_eq!(error(2, false, 2), AnalysisError::Valence { faces: 2, most: 64 });
    assert_eq!(error(0, true, 2), AnalysisError::Valence { faces: 0, most: 64 });
    assert_eq!(error(5, false, 1), AnalysisError::Rings { rings: 1, most: 8 });
    // Biermann, Levin and Zorin's 1/2, twice, at a boundary vertex of five triangles.
    let spectrum = Spectrum::new(&ring(MODIFIED, 5, true)).unwrap();
    let (a, b) = (spectrum.s0[1].value.re, spectrum.s0[2].value.re);
    assert!((a - 0.5).abs() < 1e-14 && (b - 0.5).abs() < 1e-14, "{a} {b}");
}
