use super::BlobError;

/// Appends `f32`s, little-endian.
pub(super) fn put_floats(out: &mut Vec<u8>, values: impl IntoIterator<Item = f32>) {
    for value in values {
        out.extend_from_slice(&value.to_le_bytes());
    }
}

/// The bytes that have not been read yet.
pub(super) struct Arrays<'a> {
    pub(super) rest: &'a [u8],
}

impl<'a> Arrays<'a> {
    /// Takes `count` elements of `N` words of 4 bytes. The count is checked against what
    /// there is before anything is allocated.
    pub(super) fn words<const N: usize>(
        &mut self,
        count: u64,
        array: &'static str,
    ) -> Result<impl ExactSizeIterator<Item = [[u8; 4]; N]> + use<'a, N>, BlobError> {
        let bytes = usize::try_from(count)
            .ok()
            .and_then(|count| count.checked_mul(4 * N))
            .filter(|&bytes| bytes <= self.rest.len())
            .ok_or(BlobError::Array { array })?;
        let (taken, rest) = self.rest.split_at(bytes);
        self.rest = rest;
        Ok(taken.chunks_exact(4 * N).map(|element| {
            std::array::from_fn(|word| std::array::from_fn(|byte| element[4 * word + byte]))
        }))
    }

    /// [`Self::words`] as floats.
    pub(super) fn floats<const N: usize>(
        &mut self,
        count: u64,
        array: &'static str,
    ) -> Result<impl ExactSizeIterator<Item = [f32; N]> + use<'a, N>, BlobError> {
        Ok(self
            .words::<N>(count, array)?
            .map(|words| words.map(f32::from_le_bytes)))
    }
}
