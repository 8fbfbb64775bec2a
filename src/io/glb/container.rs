use std::borrow::Cow;

use gltf::binary::{Glb, Header};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::{Buffer, Target, View};
use gltf::json::extras::Extras;
use gltf::json::material::Material;
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::{Checked::Valid, USize64};
use gltf::json::{Accessor, Index, Mesh, Node, Root, Scene, Value};

/// A GLB file under construction: the document, and one buffer whose parts all have 4-byte components,
/// so that every view starts where glTF wants it.
pub(super) struct Container {
    root: Root,
    buffer: Index<Buffer>,
    bytes: Vec<u8>,
    nodes: Vec<Index<Node>>,
}

impl Container {
    pub(super) fn new() -> Self {
        let mut root = Root::default();
        root.asset.generator = Some(concat!("formwork ", env!("CARGO_PKG_VERSION")).to_owned());
        let buffer = root.push(Buffer {
            byte_length: USize64(0), // known in the end
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        Container { root, buffer, bytes: Vec::new(), nodes: Vec::new() }
    }

    /// Positions: their bounds are part of the document.
    pub(super) fn points(&mut self, points: &[[f32; 3]]) -> Index<Accessor> {
        let bound = |choose: fn(f32, f32) -> f32| {
            let bounds = points.iter().copied().reduce(|a, b| std::array::from_fn(|i| choose(a[i], b[i])));
            bounds.map(|bounds| Value::from(bounds.to_vec()))
        };
        let accessor = self.vectors(points);
        let stored = &mut self.root.accessors[accessor.value()];
        (stored.min, stored.max) = (bound(f32::min), bound(f32::max));
        accessor
    }

    pub(super) fn vectors(&mut self, vectors: &[[f32; 3]]) -> Index<Accessor> {
        let bytes = vectors.iter().flatten().flat_map(|x| x.to_le_bytes());
        self.accessor(bytes, vectors.len(), Type::Vec3, ComponentType::F32, Target::ArrayBuffer)
    }

    pub(super) fn tangents(&mut self, tangents: &[[f32; 4]]) -> Index<Accessor> {
        let bytes = tangents.iter().flatten().flat_map(|x| x.to_le_bytes());
        self.accessor(bytes, tangents.len(), Type::Vec4, ComponentType::F32, Target::ArrayBuffer)
    }

    pub(super) fn scalars(&mut self, scalars: &[f32]) -> Index<Accessor> {
        let bytes = scalars.iter().flat_map(|x| x.to_le_bytes());
        self.accessor(bytes, scalars.len(), Type::Scalar, ComponentType::F32, Target::ArrayBuffer)
    }

    pub(super) fn indices(&mut self, indices: &[u32]) -> Index<Accessor> {
        let bytes = indices.iter().flat_map(|i| i.to_le_bytes());
        self.accessor(bytes, indices.len(), Type::Scalar, ComponentType::U32, Target::ElementArrayBuffer)
    }

    fn accessor(
        &mut self,
        bytes: impl Iterator<Item = u8>,
        count: usize,
        type_: Type,
        component_type: ComponentType,
        target: Target,
    ) -> Index<Accessor> {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let view = self.root.push(View {
            buffer: self.buffer,
            byte_length: USize64::from(self.bytes.len() - start),
            byte_offset: Some(USize64::from(start)),
            byte_stride: None,
            target: Some(Valid(target)),
            name: None,
            extensions: None,
            extras: None,
        });
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: Some(USize64(0)),
            count: USize64::from(count),
            component_type: Valid(GenericComponentType(component_type)),
            type_: Valid(type_),
            min: None,
            max: None,
            normalized: false,
            sparse: None,
            name: None,
            extensions: None,
            extras: None,
        })
    }

    /// A node of this name, with these extras and a mesh of one primitive.
    pub(super) fn node(
        &mut self,
        name: &str,
        attributes: Vec<(Semantic, Index<Accessor>)>,
        indices: Index<Accessor>,
        mode: Mode,
        material: Material,
        extras: Extras,
    ) {
        let material = self.root.push(material);
        let mesh = self.root.push(Mesh {
            name: Some(name.to_owned()),
            primitives: vec![Primitive {
                attributes: attributes
                    .into_iter()
                    .map(|(semantic, accessor)| (Valid(semantic), accessor))
                    .collect(),
                indices: Some(indices),
                material: Some(material),
                mode: Valid(mode),
                targets: None,
                extensions: None,
                extras: None,
            }],
            weights: None,
            extensions: None,
            extras: None,
        });
        let node = Node { name: Some(name.to_owned()), mesh: Some(mesh), extras, ..Default::default() };
        self.nodes.push(self.root.push(node));
    }

    /// The file; `None` if it is longer than the format's 32-bit lengths can say.
    pub(super) fn finish(mut self) -> Option<Glb<'static>> {
        let json = self.document(None)?;
        // Header, two chunk headers, and up to three bytes of padding for each chunk.
        let length = u32::try_from(json.len() + self.bytes.len() + 12 + 2 * (8 + 3)).ok()?;
        Some(Glb {
            header: Header { magic: *b"glTF", version: 2, length },
            json: Cow::Owned(json),
            bin: Some(Cow::Owned(self.bytes)),
        })
    }

    /// The document and, for a file of their own that is called `uri`, its numbers; `None` if those are
    /// longer than readers expect.
    pub(super) fn finish_text(mut self, uri: &str) -> Option<(Vec<u8>, Vec<u8>)> {
        u32::try_from(self.bytes.len()).ok()?;
        Some((self.document(Some(uri.to_owned()))?, self.bytes))
    }

    fn document(&mut self, uri: Option<String>) -> Option<Vec<u8>> {
        let nodes = std::mem::take(&mut self.nodes);
        let scene = self.root.push(Scene { nodes, name: None, extensions: None, extras: None });
        self.root.scene = Some(scene);
        let buffer = &mut self.root.buffers[self.buffer.value()];
        buffer.byte_length = USize64::from(self.bytes.len());
        buffer.uri = uri;
        self.root.to_vec().ok()
    }
}
