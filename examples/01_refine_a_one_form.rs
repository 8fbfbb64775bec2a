//! Refines a 1-form on a creased cube and checks that refinement commutes with the derivative.
//!
//! ```text
//! cargo run --example 01_refine_a_one_form
//! ```

use formwork::cochain::Cochain;
use formwork::hierarchy::Hierarchy;
use formwork::scheme::Scheme;
use formwork::topology::{Cage, Crease, Descriptor};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // A cube. Its edge 0-1 is infinitely sharp, its edge 2-3 for one and a half levels.
    let points = [[0., 0.], [1., 0.], [1., 1.], [0., 1.], [0., 0.], [1., 0.], [1., 1.], [0., 1.]];
    let cage = Cage::new(Descriptor {
        num_vertices: points.len(),
        face_sizes: vec![4; 6],
        face_vertices: vec![0, 3, 2, 1, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7],
        creases: vec![
            Crease { vertices: [0, 1], sharpness: 10.0 },
            Crease { vertices: [2, 3], sharpness: 1.5 },
        ],
        ..Default::default()
    })?;

    let levels = 3;
    let hierarchy = Hierarchy::new(&cage, Scheme::default(), levels)?;

    // One number an edge, in the edge's direction (OpenSubdiv chooses it): here the circulation of the
    // rotation (-y, x, 0) about the z axis, which along a straight edge a -> b is x_a y_b - x_b y_a.
    let circulation = |&[a, b]: &[u32; 2]| {
        let ([xa, ya], [xb, yb]) = (points[a as usize], points[b as usize]);
        xa * yb - xb * ya
    };
    let mut form = Cochain::<1>::new(hierarchy.level(0).mesh().edges().iter().map(circulation).collect());
    let mut curl = form.exterior_derivative(hierarchy.level(0).mesh());

    println!("level  edges  faces  curl, top face    |d1 S1 c - S2 d1 c|");
    for level in 1..=levels {
        form = hierarchy.refine(level, &form);
        curl = hierarchy.refine(level, &curl);
        let mesh = hierarchy.level(level).mesh();

        // The curl of the refined form is the refined curl, on every face, to rounding.
        let of_form = form.exterior_derivative(mesh);
        let pairs = of_form.values().iter().zip(curl.values());
        let difference = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // Face 1 of the cube is its top; the children of a face are numbered one after the other.
        let children = mesh.num_faces() / 6;
        let top: f64 = curl.values()[children..2 * children].iter().sum();
        println!("{level:5}  {:5}  {:5}  {top:14.6}    {difference:.1e}", mesh.num_edges(), mesh.num_faces());
        assert!(difference < 1e-14);
    }
    Ok(())
}
