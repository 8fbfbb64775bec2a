use std::collections::HashMap;

use nalgebra::Vector3;

/// Triangles of one or more primitives, one after the other.
#[derive(Default)]
pub(super) struct Soup {
    pub points: Vec<[f32; 3]>,
    /// Three indices for each triangle.
    pub triangles: Vec<u32>,
    /// The attributes `_FORM0` and `_FORM1`, if all primitives have them.
    pub form0: Option<Vec<f32>>,
    pub form1: Option<Vec<[f32; 3]>>,
}

/// A soup whose triangles hang together.
#[derive(Default)]
pub(super) struct Welded {
    pub positions: Vec<Vector3<f64>>,
    pub triangles: Vec<u32>,
    /// Means over the points that became one.
    pub form0: Option<Vec<f64>>,
    pub form1: Option<Vec<Vector3<f64>>>,
    /// Points that no triangle uses.
    pub unused: usize,
    /// Triangles two of whose corners are at the same place: they are left out.
    pub degenerate: usize,
}

impl Soup {
    /// Makes points at exactly the same place one vertex, numbered by first use. Two sides of a seam of
    /// normals or texture coordinates are such points; two sheets that touch are too, and become
    /// non-manifold there.
    pub(super) fn weld(&self) -> Welded {
        let mut welded = Welded::default();
        let mut number_at: HashMap<[u32; 3], u32> = HashMap::new();
        let mut number_of = vec![u32::MAX; self.points.len()];
        let mut members: Vec<Vec<u32>> = Vec::new();
        for triangle in self.triangles.chunks_exact(3) {
            let corners = [triangle[0], triangle[1], triangle[2]].map(|p| {
                let number = &mut number_of[p as usize];
                if *number == u32::MAX {
                    let point = self.points[p as usize];
                    // -0 and 0 are the same place.
                    *number = *number_at.entry(point.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
                        welded.positions.push(Vector3::from(point.map(f64::from)));
                        members.push(Vec::new());
                        welded.positions.len() as u32 - 1
                    });
                    members[*number as usize].push(p);
                }
                *number
            });
            if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
                welded.degenerate += 1;
            } else {
                welded.triangles.extend(corners);
            }
        }
        welded.unused = number_of.iter().filter(|&&n| n == u32::MAX).count();
        welded.form0 = self.form0.as_ref().map(|values| {
            let mean =
                |m: &Vec<u32>| m.iter().map(|&p| f64::from(values[p as usize])).sum::<f64>() / m.len() as f64;
            members.iter().map(mean).collect()
        });
        welded.form1 = self.form1.as_ref().map(|vectors| {
            let vector = |&p: &u32| Vector3::from(vectors[p as usize].map(f64::from));
            let mean = |m: &Vec<u32>| m.iter().map(vector).sum::<Vector3<f64>>() / m.len() as f64;
            members.iter().map(mean).collect()
        });
        welded
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_at_the_same_place_become_one_vertex() {
        let soup = Soup {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0; 3], [9.0; 3], [1.0, 0.0, 0.0]],
            triangles: vec![0, 1, 2, 3, 2, 1, 0, 5, 3],
            form0: Some(vec![1.0, 2.0, 3.0, 5.0, 0.0, 4.0]),
            form1: None,
        };
        let welded = soup.weld();
        assert_eq!((welded.positions.len(), welded.unused, welded.degenerate), (3, 1, 1));
        assert_eq!(welded.triangles, [0, 1, 2, 0, 2, 1]);
        assert_eq!(welded.form0.unwrap(), [3.0, 3.0, 3.0]);
    }
}
