use nalgebra::{Matrix3, Vector3};

type Vec3 = Vector3<f64>;

/// From the surface to the eye: from the front, the right and above.
pub(super) const TOWARDS_EYE: [f64; 3] = [0.52, -1.0, 0.62];
/// From the eye to what it sees, in diagonals.
pub(super) const DISTANCE: f64 = 2.2;

/// A perspective view whose rows are right, up and towards the eye.
pub(super) struct Camera {
    rows: Matrix3<f64>,
    target: Vec3,
    distance: f64,
    scale: f64,
    middle: [f64; 2],
    frame: [f64; 2],
}

impl Camera {
    /// Looks at points and fits them in a picture of so many pixels.
    pub fn facing(points: &[Vec3], bounds: [Vec3; 2], frame: [f64; 2]) -> Self {
        let forward = Vec3::from(TOWARDS_EYE).normalize();
        let right = Vec3::z().cross(&forward).normalize();
        let rows = Matrix3::from_rows(&[right, forward.cross(&right), forward].map(|r| r.transpose()));
        let size = (bounds[1] - bounds[0]).norm().max(1e-9);
        let target = (bounds[0] + bounds[1]) / 2.0;
        let mut camera =
            Camera { rows, target, distance: DISTANCE * size, scale: 1.0, middle: [0.0; 2], frame: [0.0; 2] };
        let seen: Vec<Vec3> = points.iter().map(|&p| camera.project(p)).collect();
        camera.scale = f64::MAX;
        for axis in [0, 1] {
            let low = seen.iter().map(|p| p[axis]).fold(f64::MAX, f64::min);
            let high = seen.iter().map(|p| p[axis]).fold(f64::MIN, f64::max);
            // Rows of a picture go down.
            camera.middle[axis] = if axis == 0 { 0.5 } else { -0.5 } * (low + high);
            camera.scale = camera.scale.min(0.92 * frame[axis] / (high - low).max(1e-9 * size));
        }
        camera.frame = frame;
        camera
    }

    /// Where the eye is.
    pub fn eye(&self) -> Vec3 {
        self.target + self.rows.row(2).transpose() * self.distance
    }

    /// Pixels right and down from the upper left corner, and how near: 1 over the depth in units of the distance.
    pub fn project(&self, p: Vec3) -> Vec3 {
        let q = self.rows * (p - self.target);
        let near = 1.0 / (1.0 - q.z / self.distance);
        let place = |axis: usize| self.scale * (near * q[axis] - self.middle[axis]);
        Vec3::new(self.frame[0] / 2.0 + place(0), self.frame[1] / 2.0 - place(1), near)
    }
}
