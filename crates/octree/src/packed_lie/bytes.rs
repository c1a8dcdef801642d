use glam::Vec3;

/// Why bytes are not what they should be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BytesError {
    /// They end too soon.
    End,
    /// Something in them cannot be.
    Malformed(&'static str),
}

/// Bytes that grow.
#[derive(Default)]
pub(crate) struct Writer(pub(crate) Vec<u8>);

impl Writer {
    pub(crate) fn byte(&mut self, byte: u8) {
        self.0.push(byte);
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(bytes);
    }

    /// Seven bits to a byte, the lowest first; all but the last have the highest bit set.
    pub(crate) fn number(&mut self, number: impl Into<u64>) {
        let mut rest = number.into();
        while rest >= 0x80 {
            self.byte(rest as u8 | 0x80);
            rest >>= 7;
        }
        self.byte(rest as u8);
    }

    /// A small number of either sign, as an even or odd one.
    pub(crate) fn difference(&mut self, from: u32, to: u32, bit: bool) {
        let difference = i64::from(to) - i64::from(from);
        let zigzag = ((difference << 1) ^ (difference >> 63)) as u64;
        self.number(zigzag << 1 | u64::from(bit));
    }

    pub(crate) fn float(&mut self, value: f32) {
        self.0.extend_from_slice(&value.to_le_bytes());
    }

    pub(crate) fn vector(&mut self, value: Vec3) {
        value.to_array().iter().for_each(|&value| self.float(value));
    }
}

/// Bytes that have not been read yet.
pub(crate) struct Reader<'a>(pub(crate) &'a [u8]);

impl<'a> Reader<'a> {
    pub(crate) fn byte(&mut self) -> Result<u8, BytesError> {
        self.bytes::<1>().map(|[byte]| byte)
    }

    pub(crate) fn number(&mut self) -> Result<u64, BytesError> {
        let mut number = 0;
        for shift in (0..u64::BITS).step_by(7) {
            let byte = self.byte()?;
            let bits = u64::from(byte & 0x7f);
            if bits << shift >> shift != bits {
                break;
            }
            number |= bits << shift;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
        Err(BytesError::Malformed("a number has too many digits"))
    }

    /// A number that has to fit; `what` is said if it does not.
    pub(crate) fn small<T: TryFrom<u64>>(&mut self, what: &'static str) -> Result<T, BytesError> {
        T::try_from(self.number()?).map_err(|_| BytesError::Malformed(what))
    }

    /// How many elements follow, if each takes at least so many bytes: never more than there
    /// can be.
    pub(crate) fn count(&mut self, bytes_each: usize) -> Result<usize, BytesError> {
        let count = usize::try_from(self.number()?).map_err(|_| BytesError::End)?;
        if count > self.0.len() / bytes_each {
            return Err(BytesError::End);
        }
        Ok(count)
    }

    /// [`Writer::difference`], if the sum is below `end`.
    pub(crate) fn difference(&mut self, from: u32, end: u32) -> Result<(u32, bool), BytesError> {
        let number = self.number()?;
        let zigzag = number >> 1;
        let difference = (zigzag >> 1) as i64 ^ -((zigzag & 1) as i64);
        let sum = i64::from(from).checked_add(difference);
        let sum = sum.and_then(|sum| u32::try_from(sum).ok());
        match sum.filter(|&sum| sum < end) {
            Some(sum) => Ok((sum, number & 1 == 1)),
            None => Err(BytesError::Malformed("there is no such triangle")),
        }
    }

    pub(crate) fn float(&mut self) -> Result<f32, BytesError> {
        self.bytes().map(f32::from_le_bytes)
    }

    pub(crate) fn vector(&mut self) -> Result<Vec3, BytesError> {
        Ok(Vec3::new(self.float()?, self.float()?, self.float()?))
    }

    /// The next so many.
    pub(crate) fn slice(&mut self, length: usize) -> Result<&'a [u8], BytesError> {
        let (bytes, rest) = self.0.split_at_checked(length).ok_or(BytesError::End)?;
        self.0 = rest;
        Ok(bytes)
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], BytesError> {
        let (bytes, rest) = self.0.split_first_chunk().ok_or(BytesError::End)?;
        self.0 = rest;
        Ok(*bytes)
    }
}
