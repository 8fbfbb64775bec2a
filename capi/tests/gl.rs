//! Tables in OpenSubdiv's GL evaluators, on the driver that EGL finds without a display. Skipped, having said so,
//! where there is none.

mod common;

use common::{compile, installed, run};

/// What `gl.cpp` exits with where there is no GL.
const SKIPPED: i32 = 77;

#[test]
fn gl_evaluators_take_tables_of_forms_as_they_are() {
    let has = |header: &str| std::path::Path::new("/usr/include").join(header).exists();
    if !["EGL/egl.h", "GL/glext.h", "opensubdiv/osd/glComputeEvaluator.h"].into_iter().all(has) {
        eprintln!("skipped: no headers of EGL, GL or OpenSubdiv's GL evaluators in /usr/include");
        return;
    }
    let (folder, prefix) = installed();
    let libraries = ["-losdGPU", "-lEGL", "-lGL"];
    let program = compile(folder.path(), &prefix, "tests/cpp/gl", &["-O1", "-Wno-error"], &libraries);
    let output = run(&program, &prefix, &[]);
    let printed = String::from_utf8_lossy(&output.stdout);
    println!("{printed}");
    if output.status.code() == Some(SKIPPED) {
        eprintln!("{printed}");
        return;
    }
    assert!(
        output.status.success(),
        "{}\n{printed}{}",
        output.status,
        String::from_utf8_lossy(&output.stderr)
    );
    assert_eq!(printed.lines().filter(|line| line.contains("CpuEvaluator")).count(), 4, "{printed}");
}
