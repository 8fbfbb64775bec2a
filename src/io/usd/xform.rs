use nalgebra::{Matrix4, Rotation3, Unit, Vector3};
use openusd::sdf::Value;

use super::layer::{Prim, When};

/// Takes positions from the space of a prim to that of its stage.
///
/// # Errors
/// The prim and its operation that is not known or has no value, in words.
pub(super) fn placement(prim: &Prim, when: When) -> Result<Matrix4<f64>, String> {
    let mut matrix = Matrix4::identity();
    let mut next = Some(prim.clone());
    while let Some(prim) = next.filter(|prim| !prim.path.is_abs_root()) {
        let (local, resets) = local(&prim, when).map_err(|problem| format!("{}: {problem}", prim.path))?;
        matrix = local * matrix;
        next = match resets {
            true => None,
            false => prim.path.parent().map(|path| Prim { data: prim.data, path }),
        };
    }
    Ok(matrix)
}

/// Whether a prim or one above it moves.
pub(super) fn moves(prim: &Prim) -> bool {
    let mut next = Some(prim.clone());
    while let Some(prim) = next.filter(|prim| !prim.path.is_abs_root()) {
        let operations = order(&prim);
        let attribute = |op: &String| op.trim_start_matches(INVERT).to_owned();
        if operations.iter().any(|op| prim.times(&attribute(op)).len() > 1) {
            return true;
        }
        next = prim.path.parent().map(|path| Prim { data: prim.data, path });
    }
    false
}

const INVERT: &str = "!invert!";
const RESET: &str = "!resetXformStack!";

fn order(prim: &Prim) -> Vec<String> {
    match prim.value("xformOpOrder", When::Rest) {
        Some(Value::TokenVec(tokens)) => tokens.iter().map(|token| token.as_str().to_owned()).collect(),
        Some(Value::StringVec(texts)) => texts,
        _ => Vec::new(),
    }
}

/// The operations of a prim, the last of which is applied first, and whether they forget what is above.
fn local(prim: &Prim, when: When) -> Result<(Matrix4<f64>, bool), String> {
    let (mut matrix, mut resets) = (Matrix4::identity(), false);
    for op in order(prim) {
        if op == RESET {
            (matrix, resets) = (Matrix4::identity(), true);
            continue;
        }
        let (name, inverted) = match op.strip_prefix(INVERT) {
            Some(name) => (name, true),
            None => (op.as_str(), false),
        };
        let value = prim.value(name, when).ok_or_else(|| format!("{name} has no value: give it one"))?;
        let kind = name.strip_prefix("xformOp:").and_then(|rest| rest.split(':').next()).unwrap_or_default();
        let step = operation(kind, &value).ok_or_else(|| {
            format!("{name} is no transform that is known here: bake it to xformOp:transform")
        })?;
        let step = match inverted {
            true => step.try_inverse().ok_or_else(|| format!("{name} cannot be inverted: correct it"))?,
            false => step,
        };
        matrix *= step;
    }
    Ok((matrix, resets))
}

fn operation(kind: &str, value: &Value) -> Option<Matrix4<f64>> {
    let rotation = |axes: &str, degrees: [f64; 3]| {
        // The first axis in the name turns first.
        axes.chars().zip(degrees_in_order(axes, degrees)).fold(
            Matrix4::identity(),
            |done, (axis, degrees)| {
                let axis = match axis {
                    'X' => Vector3::x_axis(),
                    'Y' => Vector3::y_axis(),
                    _ => Vector3::z_axis(),
                };
                Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous() * done
            },
        )
    };
    match kind {
        "translate" => Some(Matrix4::new_translation(&vector(value)?)),
        "scale" => Some(Matrix4::new_nonuniform_scaling(&vector(value)?)),
        "rotateX" | "rotateY" | "rotateZ" => {
            let degrees = scalar(value)?;
            Some(rotation(&kind[6..], [degrees; 3]))
        }
        "rotateXYZ" | "rotateXZY" | "rotateYXZ" | "rotateYZX" | "rotateZXY" | "rotateZYX" => {
            Some(rotation(&kind[6..], vector(value)?.into()))
        }
        "orient" => {
            let [w, x, y, z] = match value {
                Value::Quatf(q) => [q.w, q.x, q.y, q.z].map(f64::from),
                Value::Quatd(q) => [q.w, q.x, q.y, q.z],
                Value::Quath(q) => [q.w, q.x, q.y, q.z].map(|x| x.to_f64()),
                _ => return None,
            };
            // As Pixar's library does where the quaternion is not of length 1: the real part is the angle.
            let axis = Unit::try_new(Vector3::new(x, y, z), 1e-10);
            let turn = |axis| Rotation3::from_axis_angle(&axis, 2.0 * w.clamp(-1.0, 1.0).acos());
            Some(axis.map_or_else(Rotation3::identity, turn).to_homogeneous())
        }
        "transform" => match value {
            // USD multiplies rows from the left: its rows are our columns.
            Value::Matrix4d(matrix) => Some(Matrix4::from_column_slice(&matrix.0)),
            _ => None,
        },
        _ => None,
    }
}

/// The angles about X, Y and Z, in the order of the axes in the name.
fn degrees_in_order(axes: &str, [x, y, z]: [f64; 3]) -> impl Iterator<Item = f64> {
    axes.chars().map(move |axis| match axis {
        'X' => x,
        'Y' => y,
        _ => z,
    })
}

fn scalar(value: &Value) -> Option<f64> {
    match value {
        Value::Float(x) => Some(f64::from(*x)),
        Value::Double(x) => Some(*x),
        Value::Half(x) => Some(x.to_f64()),
        _ => None,
    }
}

fn vector(value: &Value) -> Option<Vector3<f64>> {
    match value {
        Value::Vec3f(v) => Some(Vector3::new(v.x, v.y, v.z).cast()),
        Value::Vec3d(v) => Some(Vector3::new(v.x, v.y, v.z)),
        Value::Vec3h(v) => Some(Vector3::new(v.x.to_f64(), v.y.to_f64(), v.z.to_f64())),
        _ => None,
    }
}
