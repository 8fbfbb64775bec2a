use openusd::sdf::{Data, Path, SpecData, SpecType, Specifier, Value};

/// Which value of an attribute that moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum When {
    /// The default value; the first sample if there is no other.
    Rest,
    /// Between samples, numbers by linear interpolation.
    At(f64),
}

/// A prim of a layer.
#[derive(Clone)]
pub(super) struct Prim<'a> {
    pub data: &'a Data,
    pub path: Path,
}

impl<'a> Prim<'a> {
    pub(super) fn root(data: &'a Data) -> Self {
        Prim { data, path: Path::abs_root() }
    }

    pub(super) fn spec(&self) -> Option<&'a SpecData> {
        self.data.spec(&self.path)
    }

    pub(super) fn children(&self) -> Vec<Prim<'a>> {
        let names = match self.spec().and_then(|spec| spec.get("primChildren")) {
            Some(Value::TokenVec(names)) => names.clone(),
            _ => Vec::new(),
        };
        let child = |name: &openusd::tf::Token| {
            let path = self.path.append_path(name.as_str()).ok()?;
            self.data.spec(&path).is_some().then_some(Prim { data: self.data, path })
        };
        names.iter().filter_map(child).collect()
    }

    /// This prim and all below it that are defined and active, parents first.
    pub(super) fn descendants(&self) -> Vec<Prim<'a>> {
        let (mut open, mut found) = (vec![self.clone()], Vec::new());
        while let Some(prim) = open.pop() {
            let is_root = prim.path.is_abs_root();
            let defined = prim.field("specifier") == Some(&Value::Specifier(Specifier::Def));
            let active = prim.field("active") != Some(&Value::Bool(false));
            if is_root || (defined && active) {
                open.extend(prim.children().into_iter().rev());
                found.push(prim);
            }
        }
        found
    }

    pub(super) fn field(&self, name: &str) -> Option<&'a Value> {
        self.spec()?.get(name)
    }

    pub(super) fn type_name(&self) -> &'a str {
        match self.field("typeName") {
            Some(Value::Token(name)) => name.as_str(),
            _ => "",
        }
    }

    pub(super) fn attribute(&self, name: &str) -> Option<&'a SpecData> {
        let path = self.path.append_property(name).ok()?;
        self.data.spec(&path).filter(|spec| spec.ty == SpecType::Attribute)
    }

    /// The value of an attribute, if it has one.
    pub(super) fn value(&self, name: &str, when: When) -> Option<Value> {
        let spec = self.attribute(name)?;
        let samples = samples(spec);
        let default = spec.get("default").filter(|value| !is_blocked(value));
        match (when, default) {
            (When::Rest, Some(value)) => Some(value.clone()),
            (When::Rest, None) => samples.first().map(|(_, value)| value.clone()),
            (When::At(_), _) if samples.is_empty() => default.cloned(),
            (When::At(time), _) => Some(between(samples, time)),
        }
    }

    /// The times of an attribute's samples, ascending.
    pub(super) fn times(&self, name: &str) -> Vec<f64> {
        let samples = self.attribute(name).map(samples).unwrap_or_default();
        samples.iter().map(|(time, _)| *time).collect()
    }

    pub(super) fn token(&self, name: &str) -> Option<String> {
        match self.value(name, When::Rest)? {
            Value::Token(token) => Some(token.as_str().to_owned()),
            Value::String(text) => Some(text),
            _ => None,
        }
    }
}

fn is_blocked(value: &Value) -> bool {
    matches!(value, Value::ValueBlock | Value::None)
}

fn samples(spec: &SpecData) -> &[(f64, Value)] {
    match spec.get("timeSamples") {
        Some(Value::TimeSamples(samples)) => samples,
        _ => &[],
    }
}

/// The value at a time: the first or last sample outside them, linear between two numbers of the same
/// shape, else the sample before.
fn between(samples: &[(f64, Value)], time: f64) -> Value {
    let after = samples.partition_point(|(t, _)| *t <= time);
    let (t0, before) = &samples[after.saturating_sub(1)];
    match samples.get(after) {
        Some((t1, next)) if after > 0 && time > *t0 => {
            mix(before, next, (time - t0) / (t1 - t0)).unwrap_or_else(|| before.clone())
        }
        _ => before.clone(),
    }
}

fn mix(a: &Value, b: &Value, s: f64) -> Option<Value> {
    let mix64 = |a: f64, b: f64| a + (b - a) * s;
    let mix32 = |a: f32, b: f32| mix64(f64::from(a), f64::from(b)) as f32;
    Some(match (a, b) {
        (Value::Float(a), Value::Float(b)) => Value::Float(mix32(*a, *b)),
        (Value::Double(a), Value::Double(b)) => Value::Double(mix64(*a, *b)),
        (Value::Vec3f(a), Value::Vec3f(b)) => Value::vec3f(mix32(a.x, b.x), mix32(a.y, b.y), mix32(a.z, b.z)),
        (Value::Vec3d(a), Value::Vec3d(b)) => Value::vec3d(mix64(a.x, b.x), mix64(a.y, b.y), mix64(a.z, b.z)),
        (Value::Matrix4d(a), Value::Matrix4d(b)) => {
            let mut matrix = *a;
            for (x, y) in matrix.0.iter_mut().zip(&b.0) {
                *x = mix64(*x, *y);
            }
            Value::Matrix4d(matrix)
        }
        (Value::Vec3fVec(a), Value::Vec3fVec(b)) if a.len() == b.len() => {
            let mut mixed = a.clone();
            for (x, y) in mixed.iter_mut().zip(b) {
                (x.x, x.y, x.z) = (mix32(x.x, y.x), mix32(x.y, y.y), mix32(x.z, y.z));
            }
            Value::Vec3fVec(mixed)
        }
        (Value::FloatVec(a), Value::FloatVec(b)) if a.len() == b.len() => {
            Value::FloatVec(a.iter().zip(b).map(|(a, b)| mix32(*a, *b)).collect())
        }
        _ => return None,
    })
}

/// Numbers of any of USD's widths.
pub(super) fn numbers(value: &Value) -> Option<Vec<f64>> {
    Some(match value {
        Value::FloatVec(v) => v.iter().map(|&x| f64::from(x)).collect(),
        Value::DoubleVec(v) => v.clone(),
        Value::HalfVec(v) => v.iter().map(|x| x.to_f64()).collect(),
        Value::IntVec(v) => v.iter().map(|&x| f64::from(x)).collect(),
        _ => return None,
    })
}

/// Triples of any of USD's widths.
pub(super) fn triples(value: &Value) -> Option<Vec<[f64; 3]>> {
    Some(match value {
        Value::Vec3fVec(v) => v.iter().map(|p| [p.x, p.y, p.z].map(f64::from)).collect(),
        Value::Vec3dVec(v) => v.iter().map(|p| [p.x, p.y, p.z]).collect(),
        Value::Vec3hVec(v) => v.iter().map(|p| [p.x, p.y, p.z].map(|x| x.to_f64())).collect(),
        _ => return None,
    })
}

/// An empty list of any kind: text files do not say of which.
pub(super) fn is_empty_list(value: &Value) -> bool {
    matches!(value, Value::ValueVec(v) if v.is_empty())
}
