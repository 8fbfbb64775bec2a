//! What becomes of the primvars of a cage when it is refined.

use openusd::gf::{Vec2d, Vec2f, Vec3d, Vec3f, Vec4d, Vec4f};
use openusd::sdf::{Path, SpecData, Value};

use super::build::Editor;
use super::layer::{Prim, When};
use crate::io::{Ancestry, Surface};

/// What became of a primvar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fate {
    /// It fits the refined mesh.
    Kept,
    /// It fits, and is only linear within faces.
    Linear,
    /// It does not fit.
    Lost,
}

/// Refines a primvar in place: constants stay, values of faces follow their faces, values of vertices are
/// refined as positions are, values of corners are interpolated linearly. Without an ancestry only constants
/// fit.
pub(super) fn refine(
    editor: &mut Editor,
    name: &str,
    surface: &Surface,
    ancestry: Option<&Ancestry>,
) -> Fate {
    let prim = Prim { data: editor.data, path: editor.prim.clone() };
    let Some(spec) = prim.attribute(name) else { return Fate::Kept };
    let interpolation = match spec.get("interpolation") {
        Some(Value::Token(token)) => token.as_str().to_owned(),
        _ => "constant".to_owned(),
    };
    if interpolation == "constant" {
        return Fate::Kept;
    }
    let wide = matches!(spec.get("elementSize"), Some(Value::Int(size)) if *size != 1);
    let Some(ancestry) = ancestry.filter(|_| !wide) else { return Fate::Lost };
    let indices = prim.value(&format!("{name}:indices"), When::Rest);
    let paths = [name.to_owned(), format!("{name}:indices")].map(|name| editor.prim.append_property(&name));
    let [Ok(path), Ok(index_path)] = paths else { return Fate::Lost };
    match interpolation.as_str() {
        "uniform" => {
            let control = ancestry.control_faces();
            let faces: Vec<u32> = surface.faces().map(|f| control[f as usize]).collect();
            let listed = if indices.is_some() { index_path } else { path };
            change(editor, &listed, Fate::Kept, |value| pick(value, &faces))
        }
        "vertex" | "varying" | "faceVarying" => {
            let fate = if interpolation == "faceVarying" { Fate::Linear } else { Fate::Kept };
            let fate = change(editor, &path, fate, |value| {
                let flat = match &indices {
                    None => value.clone(),
                    Some(Value::IntVec(indices)) => {
                        let places: Option<Vec<u32>> =
                            indices.iter().map(|&i| u32::try_from(i).ok()).collect();
                        pick(value, &places?)?
                    }
                    Some(_) => return None,
                };
                components(&flat, |values| finer(values, &interpolation, ancestry, surface))
            });
            if fate != Fate::Lost {
                editor.remove(&format!("{name}:indices"));
            }
            fate
        }
        _ => Fate::Lost,
    }
}

/// One component of the values of a primvar, on the surface; `None` if there are too few or too many.
fn finer(values: Vec<f64>, interpolation: &str, ancestry: &Ancestry, surface: &Surface) -> Option<Vec<f64>> {
    let cage = ancestry.cage();
    if interpolation != "faceVarying" {
        let fits = values.len() == cage.num_vertices();
        return fits.then(|| match interpolation {
            "vertex" => ancestry.at_vertices(values),
            _ => ancestry.linear_at_vertices(values),
        });
    }
    if values.len() != cage.num_corners() {
        return None;
    }
    // The corners of a left-handed face are turned, the first one staying.
    let turned = surface.asset().is_some_and(|asset| asset.descriptor.left_handed);
    let of_face = |f: u32| {
        let corners = cage.corners(f);
        let n = corners.len() as u32;
        (0..n).map(move |i| corners.start + if turned { (n - i) % n } else { i })
    };
    let order = (0..cage.num_faces() as u32).flat_map(of_face);
    let fine = ancestry.linear_at_corners(order.map(|c| values[c as usize]).collect());
    Some(surface.faces().flat_map(|f| surface.mesh().corners(f)).map(|c| fine[c as usize]).collect())
}

/// Changes the default and every sample of an attribute, or says that it is lost.
fn change(editor: &mut Editor, path: &Path, fate: Fate, new: impl Fn(&Value) -> Option<Value>) -> Fate {
    let Some(spec) = editor.data.spec_mut(path) else { return Fate::Lost };
    let mut fits = true;
    each_value(spec, |value| {
        new(value).unwrap_or_else(|| {
            fits = false;
            value.clone()
        })
    });
    if fits { fate } else { Fate::Lost }
}

/// Changes the default and every sample of an attribute; blocks stay.
pub(super) fn each_value(spec: &mut SpecData, mut change: impl FnMut(&Value) -> Value) {
    let mut change = |value: &mut Value| {
        if !matches!(value, Value::ValueBlock) {
            *value = change(value);
        }
    };
    if let Some(value) = spec.get_mut("default") {
        change(value);
    }
    if let Some(Value::TimeSamples(samples)) = spec.get_mut("timeSamples") {
        samples.iter_mut().for_each(|(_, value)| change(value));
    }
}

/// Each component of a list of numbers or vectors, changed by itself; `None` for other lists.
fn components(value: &Value, finer: impl Fn(Vec<f64>) -> Option<Vec<f64>>) -> Option<Value> {
    macro_rules! vectors {
        ($kind:ident, $vector:ident, $number:ty, $first:ident $(, $other:ident)*) => {
            if let Value::$kind(v) = value {
                let $first = finer(v.iter().map(|x| f64::from(x.$first)).collect())?;
                $(let $other = finer(v.iter().map(|x| f64::from(x.$other)).collect())?;)*
                let at = |i: usize| $vector { $first: $first[i] as $number $(, $other: $other[i] as $number)* };
                return Some(Value::$kind((0..$first.len()).map(at).collect()));
            }
        };
    }
    vectors!(Vec2fVec, Vec2f, f32, x, y);
    vectors!(Vec3fVec, Vec3f, f32, x, y, z);
    vectors!(Vec4fVec, Vec4f, f32, x, y, z, w);
    vectors!(Vec2dVec, Vec2d, f64, x, y);
    vectors!(Vec3dVec, Vec3d, f64, x, y, z);
    vectors!(Vec4dVec, Vec4d, f64, x, y, z, w);
    match value {
        Value::FloatVec(v) => {
            let values = finer(v.iter().map(|&x| f64::from(x)).collect())?;
            Some(Value::FloatVec(values.into_iter().map(|x| x as f32).collect()))
        }
        Value::DoubleVec(v) => Some(Value::DoubleVec(finer(v.clone())?)),
        _ => None,
    }
}

/// The entries of a list at these places; `None` if it is too short or no list.
fn pick(value: &Value, places: &[u32]) -> Option<Value> {
    macro_rules! pick {
        ($($kind:ident),+) => {
            match value {
                $(Value::$kind(v) => {
                    let at = |&i: &u32| v.get(i as usize).cloned();
                    Some(Value::$kind(places.iter().map(at).collect::<Option<_>>()?))
                })+
                _ => None,
            }
        };
    }
    pick!(
        BoolVec,
        UcharVec,
        IntVec,
        UintVec,
        Int64Vec,
        Uint64Vec,
        HalfVec,
        FloatVec,
        DoubleVec,
        StringVec,
        TokenVec,
        AssetPathVec,
        QuathVec,
        QuatfVec,
        QuatdVec,
        Vec2hVec,
        Vec2fVec,
        Vec2dVec,
        Vec2iVec,
        Vec3hVec,
        Vec3fVec,
        Vec3dVec,
        Vec3iVec,
        Vec4hVec,
        Vec4fVec,
        Vec4dVec,
        Vec4iVec,
        Matrix4dVec
    )
}
