use crate::point_group::PointGroup;

/// Groups that are used again and again: they are large, and stay where they are.
#[derive(Default)]
pub(crate) struct Groups {
    groups: Vec<PointGroup>,
    len: usize,
}

impl Groups {
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// One more, to be filled: it holds what it held before.
    pub(crate) fn push(&mut self) -> &mut PointGroup {
        if self.len == self.groups.len() {
            self.groups.push(PointGroup::new());
        }
        self.len += 1;
        &mut self.groups[self.len - 1]
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn as_slice(&self) -> &[PointGroup] {
        &self.groups[..self.len]
    }
}
