use std::sync::{Arc, OnceLock};

use crate::osd::{TagLists, Tags};
use crate::topology::{Mesh, Split};

/// One level: its complex and OpenSubdiv's tags.
#[derive(Clone, Debug)]
pub struct Level {
    /// The level above, and how it splits into this one; `None` on level 0.
    origin: Option<(Arc<Mesh>, Split)>,
    /// The finest level is the largest by far, and refining a cochain does not ask for its complex: it is
    /// made when somebody does.
    mesh: OnceLock<Arc<Mesh>>,
    /// Likewise the tags of all its cells, of which few are not smooth.
    tags: OnceLock<Tags>,
    tag_lists: TagLists,
}

impl Level {
    pub(super) fn cage(mesh: Mesh, tag_lists: TagLists) -> Self {
        Level { origin: None, mesh: OnceLock::from(Arc::new(mesh)), tags: OnceLock::new(), tag_lists }
    }

    pub(super) fn refined(parent: Arc<Mesh>, split: Split, tag_lists: TagLists) -> Self {
        Level { origin: Some((parent, split)), mesh: OnceLock::new(), tags: OnceLock::new(), tag_lists }
    }

    /// The complex.
    pub fn mesh(&self) -> &Mesh {
        self.shared_mesh()
    }

    pub(super) fn shared_mesh(&self) -> &Arc<Mesh> {
        self.mesh.get_or_init(|| {
            let (parent, split) = self.origin.as_ref().expect("level 0 has its complex");
            Arc::new(split.refine(parent))
        })
    }

    /// The complex of the level above.
    pub(super) fn above(&self) -> Option<&Arc<Mesh>> {
        self.origin.as_ref().map(|(above, _)| above)
    }

    /// Sharpness, vertex rules and holes.
    pub fn tags(&self) -> &Tags {
        self.tags.get_or_init(|| self.tag_lists.tags())
    }
}
