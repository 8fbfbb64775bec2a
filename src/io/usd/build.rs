use openusd::gf::vec3f;
use openusd::sdf::{Data, Path, SpecType, Specifier, Value, Variability};
use openusd::tf::Token;

/// Edits the attributes of one prim. Names and paths are our own or come from the layer, so that they are
/// well formed.
pub(super) struct Editor<'d> {
    pub data: &'d mut Data,
    pub prim: Path,
}

/// A value, or one for each time.
pub(super) struct Moving {
    pub rest: Value,
    pub samples: Vec<(f64, Value)>,
}

impl From<Value> for Moving {
    fn from(rest: Value) -> Self {
        Moving { rest, samples: Vec::new() }
    }
}

impl Editor<'_> {
    /// Gives an attribute a value, and metadata if it had none; what it had before goes.
    pub(super) fn set(&mut self, name: &str, type_name: &str, value: impl Into<Moving>) {
        let Ok(path) = self.prim.append_property(name) else { return };
        self.list(name);
        if self.data.spec(&path).is_none() {
            self.data.create_spec(path.clone(), SpecType::Attribute);
        }
        let Some(spec) = self.data.spec_mut(&path) else { return };
        let Moving { rest, samples } = value.into();
        spec.add("typeName", Value::token(type_name));
        spec.add("default", rest);
        spec.remove("timeSamples");
        if !samples.is_empty() {
            spec.add("timeSamples", Value::TimeSamples(samples));
        }
        // What schemas call uniform: one value, whatever the time.
        if [
            "subdivisionScheme",
            "orientation",
            "interpolateBoundary",
            "triangleSubdivisionRule",
            "doubleSided",
        ]
        .contains(&name)
        {
            spec.add("variability", Value::Variability(Variability::Uniform));
        }
    }

    /// [`Editor::set`] for an attribute with one value for each vertex, corner or face.
    pub(super) fn set_primvar(
        &mut self,
        name: &str,
        type_name: &str,
        interpolation: &str,
        value: impl Into<Moving>,
    ) {
        self.set(name, type_name, value);
        self.remove(&format!("{name}:indices"));
        self.metadata(name, "interpolation", Value::token(interpolation));
    }

    pub(super) fn metadata(&mut self, name: &str, key: &str, value: Value) {
        if let Some(spec) = self.prim.append_property(name).ok().and_then(|path| self.data.spec_mut(&path)) {
            spec.add(key, value);
        }
    }

    pub(super) fn remove(&mut self, name: &str) {
        let removed = self.prim.append_property(name).ok().and_then(|path| self.data.erase_spec(&path));
        let children = self.data.spec_mut(&self.prim).and_then(|spec| spec.get_mut("propertyChildren"));
        if let (Some(_), Some(Value::TokenVec(names))) = (removed, children) {
            names.retain(|listed| listed.as_str() != name);
        }
    }

    fn list(&mut self, name: &str) {
        let Some(spec) = self.data.spec_mut(&self.prim) else { return };
        match spec.get_mut("propertyChildren") {
            Some(Value::TokenVec(names)) => {
                if !names.iter().any(|listed| listed.as_str() == name) {
                    names.push(Token::from(name));
                }
            }
            _ => spec.add("propertyChildren", Value::token_vec([name])),
        }
    }
}

/// A stage with an empty mesh, `/Root/surface`. Metres and Y up: glTF says so, OBJ and JSON do not say.
pub(super) fn empty_stage() -> (Data, Path) {
    let mut data = Data::new();
    let root = data.create_spec(Path::abs_root(), SpecType::PseudoRoot);
    root.add("defaultPrim", Value::token("Root"));
    root.add("metersPerUnit", Value::Double(1.0));
    root.add("upAxis", Value::token("Y"));
    root.add("primChildren", Value::token_vec(["Root"]));
    let mut path = Path::abs_root();
    for (name, type_name, child) in [("Root", "Xform", Some("surface")), ("surface", "Mesh", None)] {
        // Both names are identifiers.
        path = path.append_path(name).unwrap_or(path);
        let spec = data.create_spec(path.clone(), SpecType::Prim);
        spec.add("specifier", Value::Specifier(Specifier::Def));
        spec.add("typeName", Value::token(type_name));
        if let Some(child) = child {
            spec.add("primChildren", Value::token_vec([child]));
        }
    }
    Editor { data: &mut data, prim: path.clone() }.set("doubleSided", "bool", Value::Bool(true));
    (data, path)
}

/// 32-bit triples; `None` if one overflows.
pub(super) fn triples32<'a>(triples: impl IntoIterator<Item = &'a nalgebra::Vector3<f64>>) -> Option<Value> {
    let single = |v: &nalgebra::Vector3<f64>| {
        let v = v.map(|x| x as f32);
        v.iter().all(|x| x.is_finite()).then(|| vec3f(v.x, v.y, v.z))
    };
    triples.into_iter().map(single).collect::<Option<Vec<_>>>().map(Value::Vec3fVec)
}

/// The two corners of the box round points.
pub(super) fn extent(points: &Value) -> Value {
    let Value::Vec3fVec(points) = points else { return Value::Vec3fVec(Vec::new()) };
    let bound = |choose: fn(f32, f32) -> f32| {
        let all =
            points.iter().copied().reduce(|a, b| vec3f(choose(a.x, b.x), choose(a.y, b.y), choose(a.z, b.z)));
        all.unwrap_or(vec3f(0.0, 0.0, 0.0))
    };
    Value::Vec3fVec(vec![bound(f32::min), bound(f32::max)])
}

pub(super) fn integers(values: impl IntoIterator<Item = u32>) -> Value {
    // Cages and their refinements are numbered in 31 bits.
    Value::IntVec(values.into_iter().map(|i| i as i32).collect())
}
