/// A set of lights, by number: one bit each, up to the last that is in it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LightSet {
    words: Box<[u64]>,
}

impl LightSet {
    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.words
            .iter()
            .map(|word| word.count_ones() as usize)
            .sum()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Whether a light is in it.
    #[must_use]
    pub fn contains(&self, light: u32) -> bool {
        let word = self.words.get(light as usize / 64);
        word.is_some_and(|word| word >> (light % 64) & 1 == 1)
    }

    /// The lights, in rising order.
    pub fn iter(&self) -> impl Iterator<Item = u32> {
        (0u32..).zip(&self.words).flat_map(|(index, &word)| {
            let mut left = word;
            std::iter::from_fn(move || {
                let bit = left.trailing_zeros();
                (left != 0).then(|| {
                    left &= left - 1;
                    64 * index + bit
                })
            })
        })
    }

    /// Heap memory in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.words[..])
    }
}

impl FromIterator<u32> for LightSet {
    fn from_iter<I: IntoIterator<Item = u32>>(lights: I) -> Self {
        let mut words = vec![];
        for light in lights {
            let index = light as usize / 64;
            if index >= words.len() {
                words.resize(index + 1, 0);
            }
            words[index] |= 1 << (light % 64);
        }
        Self {
            words: words.into_boxed_slice(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_holds_what_was_put_in() {
        for lights in [&[][..], &[0], &[63, 64, 65], &[7, 128, 1000]] {
            let set: LightSet = lights.iter().copied().collect();
            assert_eq!(set.iter().collect::<Vec<u32>>(), lights);
            for light in 0..1100 {
                assert_eq!(set.contains(light), lights.contains(&light));
            }
            assert_eq!(
                (set.len(), set.is_empty()),
                (lights.len(), lights.is_empty())
            );
        }
        let disordered: LightSet = [70, 3, 70].into_iter().collect();
        assert_eq!(disordered.iter().collect::<Vec<u32>>(), [3, 70]);
    }
}
