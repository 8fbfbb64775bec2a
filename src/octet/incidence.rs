/// Which items touch which: the items of `k` are `items[offsets[k]..offsets[k + 1]]`, ascending.
#[derive(Clone, Debug)]
pub(super) struct Incidence {
    offsets: Vec<usize>,
    items: Vec<u32>,
}

impl Incidence {
    /// `keys(i)` are the keys that item `i` touches.
    pub fn new<I: Iterator<Item = u32>>(
        num_keys: usize,
        num_items: usize,
        keys: impl Fn(usize) -> I,
    ) -> Self {
        let mut offsets = vec![0; num_keys + 1];
        for item in 0..num_items {
            keys(item).for_each(|key| offsets[key as usize + 1] += 1);
        }
        for k in 0..num_keys {
            offsets[k + 1] += offsets[k];
        }
        let mut next = offsets.clone();
        let mut items = vec![0; offsets[num_keys]];
        for item in 0..num_items {
            for key in keys(item) {
                items[next[key as usize]] = item as u32;
                next[key as usize] += 1;
            }
        }
        Incidence { offsets, items }
    }

    #[inline]
    pub fn of(&self, key: u32) -> &[u32] {
        &self.items[self.offsets[key as usize]..self.offsets[key as usize + 1]]
    }
}
