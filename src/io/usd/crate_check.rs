//! What must hold of a binary stage before its reader may see it: that reader allocates what a count in the
//! file says, follows offsets without keeping track, and so a few wrong bytes could cost all memory or all
//! time. Here every count is held against the bytes that are there.

use std::collections::HashSet;

/// Nested values deeper than this are refused.
const MAX_DEPTH: usize = 64;
/// LZ4 cannot pack tighter.
const LZ4_RATIO: usize = 255;

/// Types of values, by their numbers in the file.
mod kind {
    pub const INTS: std::ops::RangeInclusive<u64> = 3..=6;
    pub const HALF: u64 = 7;
    pub const FLOAT: u64 = 8;
    pub const DOUBLE: u64 = 9;
    pub const STRINGS: [u64; 3] = [10, 12, 57];
    pub const DICTIONARY: u64 = 31;
    pub const LIST_OPS: [u64; 10] = [32, 33, 34, 35, 36, 37, 38, 39, 54, 55];
    pub const REFERENCES: u64 = 35;
    pub const VECTORS: [u64; 6] = [40, 41, 45, 49, 50, 58];
    pub const TIME_SAMPLES: u64 = 46;
    pub const DOUBLE_VECTOR: u64 = 48;
    pub const TIME_CODE: u64 = 56;
}

/// Checks the bytes of a `.usdc` file.
///
/// # Errors
/// What is wrong, in words.
pub(super) fn check(bytes: &[u8]) -> Result<(), String> {
    let mut head = At { bytes, position: 8 };
    let version = head.u64()? & 0xff_ff_ff;
    let version = [version & 0xff, version >> 8 & 0xff, version >> 16];
    if version < [0, 7, 0] {
        let [a, b, c] = version;
        return Err(format!(
            "is of version {a}.{b}.{c}, older than is read: write it again with a newer USD"
        ));
    }
    let contents = head.u64()?;
    let mut contents = At { bytes, position: usize::try_from(contents).map_err(|_| broken("contents"))? };
    let sections = contents.count(32, "sections")?;
    let mut file = File { bytes, tokens: 0, strings: 0, paths: 0, reps: Vec::new(), fieldsets: 0 };
    let mut starts = Vec::new();
    for _ in 0..sections {
        let name = contents.take(16)?;
        let (start, size) = (contents.u64()? as usize, contents.u64()? as usize);
        if start.checked_add(size).is_none_or(|end| end > bytes.len()) {
            return Err(broken("table of sections"));
        }
        starts.push((name, start));
    }
    // In the order in which one needs the other.
    for wanted in ["TOKENS", "STRINGS", "FIELDS", "FIELDSETS", "PATHS", "SPECS"] {
        let is = |name: &[u8]| name.split(|&b| b == 0).next() == Some(wanted.as_bytes());
        let Some(&(_, start)) = starts.iter().find(|(name, _)| is(name)) else {
            return Err(format!("has no section {wanted}: the file is damaged, export it again"));
        };
        file.section(wanted, At { bytes, position: start }).map_err(|problem| match problem {
            Broken(what) => broken(what),
        })?;
    }
    file.values().map_err(|Broken(what)| broken(what))
}

fn broken(what: &str) -> String {
    format!("has {what} that reach beyond the file or contradict themselves: it is damaged, export it again")
}

struct Broken(&'static str);

impl From<Broken> for String {
    fn from(Broken(what): Broken) -> String {
        broken(what)
    }
}

/// A place in the file.
#[derive(Clone, Copy)]
struct At<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> At<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Broken> {
        let end = self.position.checked_add(count).ok_or(Broken("offsets"))?;
        let taken = self.bytes.get(self.position..end).ok_or(Broken("values"))?;
        self.position = end;
        Ok(taken)
    }

    fn u32(&mut self) -> Result<u32, Broken> {
        Ok(u32::from_le_bytes(self.take(4)?.try_into().map_err(|_| Broken("values"))?))
    }

    fn u64(&mut self) -> Result<u64, Broken> {
        Ok(u64::from_le_bytes(self.take(8)?.try_into().map_err(|_| Broken("values"))?))
    }

    fn rest(&self) -> usize {
        self.bytes.len().saturating_sub(self.position)
    }

    /// A count of items of at least `size` bytes that follow.
    fn count(&mut self, size: usize, what: &'static str) -> Result<usize, Broken> {
        let count = self.u64()?;
        usize::try_from(count).ok().filter(|&n| n <= self.rest() / size).ok_or(Broken(what))
    }

    /// A compressed block that holds at most `limit` bytes; returns them.
    fn block(&mut self, limit: usize) -> Result<Vec<u8>, Broken> {
        let size = self.count(1, "compressed blocks")?;
        let packed = self.take(size)?;
        // Larger blocks come in pieces, which the reader does not know.
        let (0, packed) = packed.split_first().map(|(&pieces, rest)| (pieces, rest)).ok_or(EMPTY)? else {
            return Err(Broken("compressed blocks"));
        };
        let room = limit.min(packed.len().saturating_mul(LZ4_RATIO).saturating_add(64));
        let mut unpacked = vec![0; room];
        let size = lz4_flex::block::decompress_into(packed, &mut unpacked)
            .map_err(|_| Broken("compressed blocks"))?;
        unpacked.truncate(size);
        Ok(unpacked)
    }

    /// `count` compressed integers of 4 or 8 bytes.
    fn integers(&mut self, count: usize, wide: bool) -> Result<Vec<i64>, Broken> {
        let size = if wide { 8 } else { 4 };
        let limit = count.saturating_mul(size).saturating_add(count / 4 + 16);
        let unpacked = self.block(limit)?;
        let codes = count.div_ceil(4);
        if count == 0 {
            return Ok(Vec::new());
        }
        if unpacked.len() < size + codes {
            return Err(Broken("compressed integers"));
        }
        let mut head = At { bytes: &unpacked, position: 0 };
        let common = head.signed(size)?;
        let mut data = At { bytes: &unpacked, position: size + codes };
        let mut value = 0i64;
        let mut values = Vec::with_capacity(count);
        for i in 0..count {
            let code = unpacked[size + i / 4] >> (2 * (i % 4)) & 3;
            value = value.wrapping_add(match code {
                0 => common,
                code => data.signed((size / 4) << (code - 1))?,
            });
            values.push(if wide { value } else { i64::from(value as i32) });
        }
        // The reader decodes the rest of the last group too.
        for i in count..codes * 4 {
            let code = unpacked[size + i / 4] >> (2 * (i % 4)) & 3;
            if code != 0 {
                data.take((size / 4) << (code - 1))?;
            }
        }
        Ok(values)
    }

    fn signed(&mut self, size: usize) -> Result<i64, Broken> {
        let taken = self.take(size)?;
        let filler = if taken.last().is_some_and(|&b| b >= 0x80) { 0xff } else { 0 };
        let mut all = [filler; 8];
        all[..size].copy_from_slice(taken);
        Ok(i64::from_le_bytes(all))
    }

    fn jump(&mut self) -> Result<At<'a>, Broken> {
        let from = self.position as i64;
        let offset = self.u64()? as i64;
        let position = from.checked_add(offset).and_then(|p| usize::try_from(p).ok());
        Ok(At { bytes: self.bytes, position: position.ok_or(Broken("offsets"))? })
    }
}

const EMPTY: Broken = Broken("compressed blocks");

/// Values that were checked, and how many more there can be.
struct Seen {
    values: HashSet<u64>,
    budget: usize,
}

struct File<'a> {
    bytes: &'a [u8],
    tokens: usize,
    strings: usize,
    paths: usize,
    fieldsets: usize,
    reps: Vec<u64>,
}

impl File<'_> {
    fn section(&mut self, name: &str, mut at: At) -> Result<(), Broken> {
        let below = |values: &[i64], count: usize, what| {
            let inside = |&v: &i64| v >= 0 && (v as usize) < count;
            if values.iter().all(inside) { Ok(()) } else { Err(Broken(what)) }
        };
        match name {
            "TOKENS" => {
                let count = at.u64()? as usize;
                let size = at.u64()? as usize;
                let unpacked = at.block(size)?;
                let ends = unpacked.iter().filter(|&&b| b == 0).count();
                if unpacked.len() != size || ends != count {
                    return Err(Broken("tokens"));
                }
                self.tokens = count;
            }
            "STRINGS" => {
                self.strings = at.count(4, "strings")?;
                for _ in 0..self.strings {
                    if at.u32()? as usize >= self.tokens {
                        return Err(Broken("strings"));
                    }
                }
            }
            "FIELDS" => {
                let count = at.u64()? as usize;
                below(&at.integers(count, false)?, self.tokens, "fields")?;
                let unpacked = at.block(count.saturating_mul(8))?;
                if unpacked.len() != count.saturating_mul(8) {
                    return Err(Broken("fields"));
                }
                let rep = |b: &[u8]| b.iter().rev().fold(0, |rep, &b| rep << 8 | u64::from(b));
                self.reps = unpacked.chunks_exact(8).map(rep).collect();
            }
            "FIELDSETS" => {
                let count = at.u64()? as usize;
                let sets = at.integers(count, false)?;
                let ends = |&v: &i64| v == -1;
                let fields: Vec<i64> = sets.iter().copied().filter(|v| !ends(v)).collect();
                below(&fields, self.reps.len(), "sets of fields")?;
                self.fieldsets = sets.len();
            }
            "PATHS" => {
                self.paths = at.u64()? as usize;
                let count = at.u64()? as usize;
                let [places, names, jumps] = [0; 3].map(|_| at.integers(count, false));
                let (places, names, jumps) = (places?, names?, jumps?);
                // The empty path is counted and not listed.
                if count > self.paths || self.paths > count.saturating_add(1) {
                    return Err(Broken("paths"));
                }
                below(&places, self.paths, "paths")?;
                let names: Vec<i64> = names.iter().map(|v| v.abs()).collect();
                below(names.get(1..).unwrap_or_default(), self.tokens, "paths")?;
                tree(&jumps)?;
            }
            _ => {
                let count = at.u64()? as usize;
                below(&at.integers(count, false)?, self.paths, "specs")?;
                below(&at.integers(count, false)?, self.fieldsets, "specs")?;
                at.integers(count, false)?;
            }
        }
        Ok(())
    }

    /// Every value of a field.
    fn values(&self) -> Result<(), Broken> {
        let mut seen = Seen { values: HashSet::new(), budget: self.bytes.len() };
        self.reps.iter().try_for_each(|&rep| self.value(rep, 0, &mut seen))
    }

    fn value(&self, rep: u64, depth: usize, seen: &mut Seen) -> Result<(), Broken> {
        if depth > MAX_DEPTH {
            return Err(Broken("nested values"));
        }
        let (array, inlined, compressed) = (rep >> 63 & 1 == 1, rep >> 62 & 1 == 1, rep >> 61 & 1 == 1);
        let kind = rep >> 48 & 0xff;
        // A dictionary is looked through wherever it occurs: it may be inside itself.
        if inlined || (kind != kind::DICTIONARY && !seen.values.insert(rep)) {
            return Ok(());
        }
        seen.budget = seen.budget.checked_sub(1).ok_or(Broken("nested values"))?;
        let mut at = At { bytes: self.bytes, position: (rep & ((1 << 48) - 1)) as usize };
        if array {
            return match (kind, at.position) {
                (_, 0) => Ok(()),
                (kind, _) if kind::STRINGS.contains(&kind) => at.count(4, "arrays").map(drop),
                _ if compressed => packed_array(kind, at),
                _ => at.count(1, "arrays").map(drop),
            };
        }
        match kind {
            kind::DOUBLE_VECTOR => at.count(8, "arrays").map(drop),
            kind if kind::VECTORS.contains(&kind) => at.count(4, "arrays").map(drop),
            kind if kind::LIST_OPS.contains(&kind) => {
                let head = at.take(1)?[0];
                for bit in 1..7 {
                    if head >> bit & 1 == 1 {
                        let count = at.count(4, "lists")?;
                        if kind == kind::REFERENCES {
                            for _ in 0..count {
                                at.take(8 + 16)?;
                                at = self.dictionary(at, depth, seen)?;
                            }
                        } else if kind == 55 {
                            at.take(count.saturating_mul(8 + 16))?;
                        } else {
                            let wide = [37, 39].contains(&kind);
                            at.take(count.saturating_mul(if wide { 8 } else { 4 }))?;
                        }
                    }
                }
                Ok(())
            }
            kind::DICTIONARY => self.dictionary(at, depth, seen).map(drop),
            kind::TIME_SAMPLES => {
                let mut times = at.jump()?;
                let rep = times.u64()?;
                self.value(rep, depth + 1, seen)?;
                let mut values = times.jump()?;
                for _ in 0..values.count(8, "time samples")? {
                    let rep = values.u64()?;
                    // A sample that is a set of samples would be read without end.
                    if rep >> 48 & 0xff == kind::TIME_SAMPLES {
                        return Err(Broken("time samples"));
                    }
                    self.value(rep, depth + 1, seen)?;
                }
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn dictionary<'b>(&self, mut at: At<'b>, depth: usize, seen: &mut Seen) -> Result<At<'b>, Broken> {
        for _ in 0..at.count(12, "dictionaries")? {
            at.u32()?;
            let mut value = at.jump()?;
            let rep = value.u64()?;
            self.value(rep, depth + 1, seen)?;
            at = value;
        }
        Ok(at)
    }
}

fn packed_array(kind: u64, mut at: At) -> Result<(), Broken> {
    let count = at.u64()? as usize;
    if count < 4 {
        return Ok(());
    }
    let wide = kind == 5 || kind == 6;
    match kind {
        kind if kind::INTS.contains(&kind) => at.integers(count, wide).map(drop),
        kind::HALF | kind::FLOAT | kind::DOUBLE | kind::TIME_CODE => match at.take(1)?[0] {
            b'i' => at.integers(count, false).map(drop),
            b't' => {
                let table = at.u32()? as usize;
                let size = match kind {
                    kind::HALF => 2,
                    kind::FLOAT => 4,
                    _ => 8,
                };
                at.take(table.saturating_mul(size))?;
                let indices = at.integers(count, false)?;
                let inside = |&i: &i64| i >= 0 && (i as usize) < table;
                if indices.iter().all(inside) { Ok(()) } else { Err(Broken("arrays")) }
            }
            _ => Err(Broken("arrays")),
        },
        _ => Err(Broken("arrays")),
    }
}

/// Whether the jumps between paths lead to each of them once: `> 0` a child follows and a sibling is that far
/// ahead, `0` a sibling follows, `-1` a child follows, `-2` neither.
fn tree(jumps: &[i64]) -> Result<(), Broken> {
    let mut seen = vec![false; jumps.len()];
    let mut open = if jumps.is_empty() { Vec::new() } else { vec![0] };
    while let Some(i) = open.pop() {
        match seen.get_mut(i) {
            Some(seen) if !*seen => *seen = true,
            _ => return Err(Broken("paths")),
        }
        if jumps[i] > 0 {
            open.push(i.saturating_add(jumps[i] as usize));
        }
        if jumps[i] >= -1 {
            open.push(i + 1);
        }
    }
    Ok(())
}
