//! Prints the C header of the crate next door.

use std::path::Path;

fn main() {
    let capi = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("a folder of capi");
    let config = cbindgen::Config::from_file(capi.join("cbindgen.toml")).expect("cbindgen.toml");
    let header = cbindgen::Builder::new().with_src(capi.join("src/lib.rs")).with_config(config).generate();
    header.expect("the C ABI has a header").write(std::io::stdout());
}
