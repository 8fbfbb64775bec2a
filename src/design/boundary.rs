use super::DesignError;
use crate::topology::{HalfEdge, Mesh};

/// What a field does at a boundary loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Condition {
    /// It runs along the boundary: nothing flows through (Neumann's condition on potentials, absolute forms). Imposed
    /// by the inner product, so exact in the mean against every basis function and approached pointwise as the cage is
    /// refined.
    #[default]
    Tangential,
    /// It crosses at right angles: no circulation along the boundary (Dirichlet's condition, relative forms). The
    /// coefficients of the loop's edges are 0, and so is the limit along it, exactly.
    Normal,
}

/// The boundary loops, each as the half-edges that have the surface on their left, in the order of their first edges.
///
/// # Errors
/// If an edge has three faces or more, or two that run along it in the same direction.
pub fn boundary_loops(mesh: &Mesh) -> Result<Vec<Vec<HalfEdge>>, DesignError> {
    if let Some(e) = (0..mesh.num_edges() as u32).find(|&e| mesh.is_non_manifold_edge(e)) {
        let (vertices, faces) = (mesh.edges()[e as usize], mesh.num_edge_faces(e));
        return Err(DesignError::NonManifold { vertices, faces });
    }
    let inner = |e: u32| {
        let h = HalfEdge::new(e, true);
        if mesh.left_corner(h).is_some() { h } else { h.twin() }
    };
    let mut seen = vec![false; mesh.num_edges()];
    let mut loops = Vec::new();
    for e in (0..mesh.num_edges() as u32).filter(|&e| mesh.is_boundary_edge(e)) {
        let mut ring = Vec::new();
        let mut h = inner(e);
        while !std::mem::replace(&mut seen[h.edge() as usize], true) {
            ring.push(h);
            let mut corner = mesh.next_corner(mesh.left_corner(h).expect("the surface is on the left"));
            h = loop {
                let out = mesh.corner_half_edge(corner);
                match mesh.left_corner(out.twin()) {
                    Some(across) => corner = mesh.next_corner(across),
                    None => break out,
                }
            };
        }
        if !ring.is_empty() {
            loops.push(ring);
        }
    }
    Ok(loops)
}
