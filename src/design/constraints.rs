use nalgebra::{DMatrix, DVector};

use super::DesignError;
use super::hodge::{Hodge, transposed_d0};
use super::spec::{Place, Spec};
use super::wishes::{Wish, check_number, check_weight};
use crate::cochain::Cochain;
use crate::sparse::apply;
use crate::sparse::inner;

/// A designed field.
#[derive(Clone, Debug)]
pub struct Field {
    /// `c = d0 a + delta b + h`: its subdivision is the field.
    pub cochain: Cochain<1>,
    /// The divergence that the field has, tested with each vertex's function: what was asked for, less what balancing
    /// took off, more what prescribed values added. It says nothing of vertices on normal loops.
    pub divergence: Cochain<0>,
    /// Its curl, `d1 c`.
    pub curl: Cochain<2>,
    /// The circulations of its harmonic part round the cycles of the generators.
    pub circulations: Vec<f64>,
    /// What was taken off to balance: the sum of sources, and of vortices, over all components.
    pub balanced: [f64; 2],
    /// The largest miss of a prescribed value without weight.
    pub miss: f64,
}

/// What one unit of a wish's multiplier adds to the data: divergence over vertices, curl over faces.
struct Response {
    divergence: Vec<f64>,
    curl: Vec<f64>,
}

impl Hodge<'_> {
    /// The field with these features: what is asked for, and nothing else.
    ///
    /// Sources, vortices and circulations fix the field (one solution with the factor). Prescribed edge values and
    /// vectors add the divergence and the curl, spread as thinly as they go: least in
    /// `sum_v w_v div_v^2 / area_v + sum_f w_f curl_f^2 / area_f`, the energy `|d c|^2 + |delta c|^2` with lumped masses, plus
    /// `weight * miss^2` for those that have a weight. Each costs one solution more. The energy of Fisher, Schroeder,
    /// Desbrun, Hoppe, "Design of tangent vector fields", 2007, is the same but for the masses.
    ///
    /// # Errors
    /// If the spec names what is not there, contradicts itself, or does not balance and is not to be balanced.
    pub fn design(&self, spec: &Spec) -> Result<Field, DesignError> {
        let mesh = self.mesh();
        let mut divergence = vec![0.0; mesh.num_vertices()];
        for (index, source) in spec.sources.iter().enumerate() {
            check_number("source", index, source.strength)?;
            self.put(0, source.place, source.strength, &mut divergence)?;
        }
        let mut curl = vec![0.0; mesh.num_faces()];
        for (index, vortex) in spec.vortices.iter().enumerate() {
            check_number("vortex", index, vortex.strength)?;
            self.put(2, vortex.place, vortex.strength, &mut curl)?;
        }
        let (areas, homology) = (self.product(), self.homology());
        let of_vertex = |v: usize| homology.balancing_component(v as u32);
        let of_face = |f: usize| homology.closed_component(f as u32);
        let counts = [homology.num_components(), homology.num_closed_components()];
        let balanced = [
            balance(
                "sources",
                "vertex",
                &mut divergence,
                &areas.vertex_areas,
                of_vertex,
                counts[0],
                spec.balance,
            )?,
            balance("vortices", "face", &mut curl, &areas.face_areas, of_face, counts[1], spec.balance)?,
        ];
        // A cell's source has the divergence of its function, as a face's vortex has the curl of its 2-form.
        if !spec.sources.is_empty() {
            let product = self.product();
            let densities = divergence.iter().zip(&product.vertex_areas);
            let densities: Vec<f64> =
                densities.map(|(q, area)| if *q == 0.0 { 0.0 } else { q / area }).collect();
            divergence = apply(&product.vertex_mass, &densities);
        }
        let mut circulations = vec![None; homology.generators().len()];
        for &(number, value) in &spec.harmonic {
            check_number("harmonic coefficient", number, value)?;
            let count = circulations.len();
            *circulations.get_mut(number).ok_or(DesignError::NoGenerator { number, count })? = Some(value);
        }

        let wishes = self.wishes(spec)?;
        let mut harmonic: Vec<f64> = circulations.iter().map(|x| x.unwrap_or(0.0)).collect();
        let (mut miss, mut scale) = (0.0, 0.0);
        if !wishes.is_empty() {
            let free: Vec<usize> = (0..harmonic.len()).filter(|&i| circulations[i].is_none()).collect();
            let start = self.compose(&divergence, &curl, &harmonic);
            let sizes = wishes.iter().map(|wish| wish.value.abs() + inner(&wish.functional, &start).abs());
            scale = sizes.fold(0.0, f64::max);
            let weights = self.energy_weights(spec)?;
            let responses: Vec<Response> = wishes.iter().map(|wish| self.respond(wish, &weights)).collect();
            let (multipliers, more) = self.settle(&wishes, &responses, &weights, &free, &start)?;
            for (response, &lambda) in responses.iter().zip(&multipliers) {
                divergence.iter_mut().zip(&response.divergence).for_each(|(x, y)| *x += lambda * y);
                curl.iter_mut().zip(&response.curl).for_each(|(x, y)| *x += lambda * y);
            }
            free.iter().zip(more).for_each(|(&i, x)| harmonic[i] += x);
        }
        let cochain: Cochain<1> = Cochain::new(self.compose(&divergence, &curl, &harmonic));
        for wish in wishes.iter().filter(|wish| wish.weight.is_none()) {
            miss = f64::max(miss, (inner(&wish.functional, cochain.values()) - wish.value).abs());
        }
        // What cannot be met at all stands out from what rounding leaves.
        if miss > 1e-6 * scale {
            return Err(DesignError::Contradiction { off: miss / scale });
        }
        Ok(Field {
            divergence: Cochain::new(divergence),
            curl: cochain.exterior_derivative(mesh),
            cochain,
            circulations: harmonic,
            balanced,
            miss,
        })
    }

    /// The cochain with this divergence and curl, and these circulations of its harmonic part.
    fn compose(&self, divergence: &[f64], curl: &[f64], harmonic: &[f64]) -> Vec<f64> {
        let mesh = self.mesh();
        let generators = vec![0.0; harmonic.len()];
        let has_curl = curl.iter().any(|&x| x != 0.0);
        let mut c = match has_curl {
            true => self.homology().with_curl(mesh, curl, &generators),
            false => vec![0.0; mesh.num_edges()],
        };
        // d0' M1 (c - d0 a) = -divergence
        let mut right = match has_curl {
            true => transposed_d0(mesh, &apply(&self.product().mass, &c)),
            false => vec![0.0; mesh.num_vertices()],
        };
        right.iter_mut().zip(divergence).for_each(|(x, y)| *x += y);
        let a = self.solve(&right);
        for (x, &[tail, head]) in c.iter_mut().zip(mesh.edges()) {
            *x -= a[head as usize] - a[tail as usize];
        }
        if has_curl {
            self.remove_harmonic(&mut c, 1);
        }
        if harmonic.iter().any(|&x| x != 0.0) {
            c.iter_mut().zip(self.harmonic(harmonic).values()).for_each(|(x, y)| *x += y);
        }
        c
    }

    /// Adds a strength to the cell at a place, or shares it among the cells whose forms are there.
    fn put(&self, degree: usize, place: Place, strength: f64, data: &mut [f64]) -> Result<(), DesignError> {
        match place {
            Place::Cell(number) => {
                let (what, count) = (["vertex", "edge", "face"][degree], data.len());
                let cell = data.get_mut(number as usize);
                *cell.ok_or(DesignError::NoCell { what, number, count })? += strength;
            }
            Place::At(point) => {
                self.surface().check(&point)?;
                let point = if degree == 2 { self.off_rim(point) } else { point };
                let shares = self.functional(degree, &point)?;
                let sum: f64 = shares.iter().map(|(_, weight)| weight[0]).sum();
                shares.iter().for_each(|(cell, weight)| data[*cell as usize] += strength * weight[0] / sum);
            }
        }
        Ok(())
    }

    /// The areas of vertices and faces over the weights of their regions.
    fn energy_weights(&self, spec: &Spec) -> Result<[Vec<f64>; 2], DesignError> {
        let mesh = self.mesh();
        let mut factor = vec![1.0; mesh.num_faces()];
        for (index, region) in spec.regions.iter().enumerate() {
            check_weight("weight of region", index, Some(region.weight))?;
            for &face in &region.faces {
                let count = mesh.num_faces();
                let cell = factor.get_mut(face as usize);
                *cell.ok_or(DesignError::NoCell { what: "face", number: face, count })? = region.weight;
            }
        }
        let product = self.product();
        let vertices = (0..mesh.num_vertices() as u32).map(|v| {
            let corners = || mesh.fans(v).flat_map(|fan| fan.corners);
            let sum: f64 = corners().map(|&c| factor[mesh.corner_face(c) as usize]).sum();
            let mean = sum / corners().count().max(1) as f64;
            if self.homology().is_fixed_vertex(v) {
                0.0
            } else {
                product.vertex_areas[v as usize].max(0.0) / mean
            }
        });
        let faces = product.face_areas.iter().zip(&factor).map(|(area, factor)| area / factor);
        Ok([vertices.collect(), faces.collect()])
    }

    /// The least costly data with an effect on a wish. A divergence `q` makes the field `-d0 K^-1 q`, a curl its
    /// coexact one, so the wish counts `y . q + z . curl` with
    /// `y = -K^-1 d0' b`, `z` the transpose of [`Homology::with_curl`](super::Homology::with_curl) of `b` less what sees
    /// exact and harmonic fields only.
    fn respond(&self, wish: &Wish, [vertices, faces]: &[Vec<f64>; 2]) -> Response {
        let mesh = self.mesh();
        let u = self.solve(&transposed_d0(mesh, &wish.functional));
        let mut seen = Cochain::<0>::new(u.clone()).exterior_derivative(mesh).into_values();
        for form in self.orthonormal_basis() {
            let weight = inner(form, &wish.functional);
            seen.iter_mut().zip(form).for_each(|(x, y)| *x += weight * y);
        }
        let image = apply(&self.product().mass, &seen);
        let functional: Vec<f64> = wish.functional.iter().zip(&image).map(|(b, m)| b - m).collect();
        let z = self.homology().of_curl(mesh, &functional);
        let y: Vec<f64> = u.iter().map(|x| -x).collect();
        let homology = self.homology();
        let of_vertex = |v: usize| homology.balancing_component(v as u32);
        let of_face = |f: usize| homology.closed_component(f as u32);
        Response {
            divergence: spread(y, vertices, of_vertex, homology.num_components()),
            curl: spread(z, faces, of_face, homology.num_closed_components()),
        }
    }

    /// The multipliers of the wishes, and what the free harmonic coefficients gain.
    fn settle(
        &self,
        wishes: &[Wish],
        responses: &[Response],
        [vertices, faces]: &[Vec<f64>; 2],
        free: &[usize],
        start: &[f64],
    ) -> Result<(Vec<f64>, Vec<f64>), DesignError> {
        let (m, n) = (wishes.len(), free.len());
        let product = |r: &Response, s: &Response| {
            let sum = |x: &[f64], y: &[f64], areas: &[f64]| {
                let terms = x.iter().zip(y).zip(areas).filter(|(_, area)| **area > 0.0);
                terms.map(|((x, y), area)| x * y / area).sum::<f64>()
            };
            sum(&r.divergence, &s.divergence, vertices) + sum(&r.curl, &s.curl, faces)
        };
        let mut system = DMatrix::zeros(m + n, m + n);
        for i in 0..m {
            for j in 0..=i {
                let entry = product(&responses[i], &responses[j]);
                (system[(i, j)], system[(j, i)]) = (entry, entry);
            }
        }
        let typical = (0..m).map(|i| system[(i, i)]).fold(f64::MIN_POSITIVE, f64::max);
        for (i, wish) in wishes.iter().enumerate() {
            system[(i, i)] += wish.weight.map_or(0.0, |weight| 1.0 / weight);
            for (j, &generator) in free.iter().enumerate() {
                let entry = inner(&wish.functional, &self.harmonic_basis()[generator]) * typical.sqrt();
                (system[(i, m + j)], system[(m + j, i)]) = (entry, entry);
            }
        }
        let mut right = DVector::zeros(m + n);
        for (i, wish) in wishes.iter().enumerate() {
            right[i] = wish.value - inner(&wish.functional, start);
        }
        // Repeated wishes, and circulations that no wish sees, leave directions free: those stay 0.
        let svd = system.svd(true, true);
        let cut = 1e-11 * svd.singular_values.max();
        let found = svd.solve(&right, cut).map_err(|_| DesignError::Contradiction { off: f64::NAN })?;
        let multipliers = found.rows(0, m).iter().copied().collect();
        let circulations = found.rows(m, n).iter().map(|x| x * typical.sqrt()).collect();
        Ok((multipliers, circulations))
    }
}

/// `(y - mean) * area` where it has to balance, `y * area` elsewhere.
fn spread(y: Vec<f64>, areas: &[f64], component: impl Fn(usize) -> Option<usize>, count: usize) -> Vec<f64> {
    let mut sums = vec![[0.0; 2]; count];
    for (i, (&y, &area)) in y.iter().zip(areas).enumerate() {
        if let Some(component) = component(i) {
            sums[component][0] += area * y;
            sums[component][1] += area;
        }
    }
    let mean = |i: usize| component(i).map_or(0.0, |c| sums[c][0] / sums[c][1].max(f64::MIN_POSITIVE));
    y.iter().zip(areas).enumerate().map(|(i, (y, area))| area * (y - mean(i))).collect()
}

/// Takes the excess of each component off by area; the sum of what was taken.
fn balance(
    what: &'static str,
    cell: &'static str,
    data: &mut [f64],
    areas: &[f64],
    component: impl Fn(usize) -> Option<usize>,
    count: usize,
    allowed: bool,
) -> Result<f64, DesignError> {
    // The sum of the data, of its magnitudes and of areas, and the first cell.
    let mut sums = vec![([0.0f64; 3], 0usize); count];
    for (i, (&x, &area)) in data.iter().zip(areas).enumerate().rev() {
        if let Some(component) = component(i) {
            let (sums, first) = &mut sums[component];
            *sums = [sums[0] + x, sums[1] + x.abs(), sums[2] + area];
            *first = i;
        }
    }
    let excess = |c: usize| Some(sums[c].0).filter(|s| s[0].abs() > 1e-9 * s[1]);
    if let Some(bad) = (0..count).find(|&c| excess(c).is_some() && !allowed) {
        let (sums, first) = &sums[bad];
        return Err(DesignError::Unbalanced { what, cell: format!("{cell} {first}"), sum: sums[0] });
    }
    // Rounding is taken off as well: what is left of it would gather at one cell.
    for (i, x) in data.iter_mut().enumerate() {
        if let Some((s, _)) = component(i).map(|c| sums[c]).filter(|(s, _)| s[0] != 0.0 && s[2] > 0.0) {
            *x -= s[0] * areas[i] / s[2];
        }
    }
    Ok((0..count).filter_map(excess).map(|s| s[0]).sum())
}
