//! Draws the limit surface of a cage with the tangent field of its 1-form, without a browser: what `formwork view
//! --png` does.
//!
//! ```text
//! cargo run --release --example 02_picture -- [MESH.obj [FIELD.json [OUT.png [LEVELS]]]]
//! ```

use std::path::Path;

use formwork::hierarchy::Hierarchy;
use formwork::io::{fields, obj};
use formwork::scheme::Scheme;
use formwork::view::{Options, View};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let argument = |i, default: &str| std::env::args().nth(i).unwrap_or(default.into());
    let asset = obj::read(Path::new(&argument(1, "assets/creased_box.obj")))?;
    let (cage, scheme) = (asset.cage()?, Scheme::default());
    let edges = Hierarchy::new(&cage, scheme, 0)?;
    let fields =
        fields::read(Path::new(&argument(2, "assets/creased_box.field.json")), edges.level(0).mesh())?;
    let options = Options { levels: argument(4, "4").parse()?, ..Options::default() };
    let view = View::new(&cage, scheme, &asset.positions, &fields, &options)?;
    let out = argument(3, "creased_box.png");
    std::fs::write(&out, view.picture([1400, 1000])?.encode_png()?)?;
    println!("{out}: {} faces, {} strokes", view.finest().face_sizes.len(), view.strokes.len());
    Ok(())
}
