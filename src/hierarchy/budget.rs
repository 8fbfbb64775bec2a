use super::HierarchyError;
use crate::osd::MAX_LEVELS;
use crate::topology::{Cage, SplitKind};

/// What a hierarchy costs for each face of its finest level, OpenSubdiv's refiner included, all levels
/// together. Measured with `cargo bench` (its last table prints the peak); rounded up.
const BYTES_PER_FACE: u128 = 1200;

/// Refuses a hierarchy that cannot fit, before OpenSubdiv fills the memory trying.
pub(super) fn check(cage: &Cage, split: SplitKind, levels: usize) -> Result<(), HierarchyError> {
    if levels > MAX_LEVELS {
        return Err(HierarchyError::TooManyLevels { levels });
    }
    let d = cage.descriptor();
    let faces = match (split, levels) {
        (SplitKind::Quad, 1..) => (d.face_vertices.len() as u128) << (2 * (levels - 1)),
        _ => (d.face_sizes.len() as u128) << (2 * levels),
    };
    // Of all counts the corners are the most, four a face.
    if 4 * faces > i32::MAX as u128 {
        return Err(HierarchyError::TooManyFaces { level: levels, faces });
    }
    let needed = faces * BYTES_PER_FACE + round_vertices(cage) * levels as u128;
    match available_memory() {
        Some(available) if needed > available => Err(HierarchyError::TooMuchMemory {
            level: levels,
            faces,
            needed_mib: needed >> 20,
            available_mib: available >> 20,
        }),
        _ => Ok(()),
    }
}

/// A vertex of valence `k` couples `k` faces with `k` edges, on every level: 12 bytes an entry of `H1`.
fn round_vertices(cage: &Cage) -> u128 {
    let d = cage.descriptor();
    let mut valence = vec![0u32; d.num_vertices];
    for &v in &d.face_vertices {
        valence[v as usize] += 1;
    }
    valence.iter().map(|&k| 12 * u128::from(k) * u128::from(k)).sum()
}

/// The memory that can be had without swapping, where the system says so.
pub(crate) fn available_memory() -> Option<u128> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kib: u128 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kib << 10)
}
