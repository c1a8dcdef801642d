use lie_geom::Aabb;

use super::{
    bytes::{BytesError, Reader},
    flag, verdict,
};
use crate::{Lie, LightEvidence, Mask, Occluder, Proof, Region, TriangleSet, masking::Shown};

/// Fewest bytes of a light's evidence, and of what is certain of one.
const EVIDENCE: usize = 6;
const VERDICT: usize = 1;

/// Said of a number of rays that does not fit.
const RAYS: &str = "too many rays";

/// What there is in the scene, where bytes may name anything.
#[derive(Clone, Copy)]
pub(crate) struct Limits {
    /// How many lights.
    pub(crate) lights: u32,
    /// How many triangles.
    pub(crate) triangles: u32,
}

/// A cell; without limits, one whose bytes are the program's own.
pub(crate) fn lie(bytes: &mut Reader<'_>, limits: Option<Limits>) -> Result<Lie, BytesError> {
    LieReader { bytes, limits }.lie()
}

struct LieReader<'r, 'a> {
    bytes: &'r mut Reader<'a>,
    limits: Option<Limits>,
}

impl LieReader<'_, '_> {
    fn lie(&mut self) -> Result<Lie, BytesError> {
        let bytes = &mut *self.bytes;
        let (samples, dark) = (
            bytes.small("too many samples")?,
            bytes.small("too much dark")?,
        );
        let version = bytes.number()?;
        let least = match self.bytes.byte()? {
            0 => None,
            _ => Some(self.luminance()?),
        };
        let region = self.region()?;
        let count = self.bytes.count(EVIDENCE)?;
        let mut lights = Vec::with_capacity(count);
        let mut next = 0;
        for _ in 0..count {
            let light = self.light(&mut next, 0)?.0;
            lights.push(self.evidence(light)?);
        }
        Ok(Lie {
            samples,
            dark,
            lights,
            region,
            shown: Shown { least },
            version,
        })
    }

    fn region(&mut self) -> Result<Region, BytesError> {
        if self.bytes.byte()? == 0 {
            return Ok(Region::default());
        }
        let (min, max) = (self.bytes.vector()?, self.bytes.vector()?);
        let bounds = Aabb { min, max };
        let is_box = min.is_finite() && max.is_finite() && !bounds.is_empty();
        if self.limits.is_some() && !is_box {
            return Err(BytesError::Malformed("a region is not a box"));
        }
        let count = self.bytes.count(VERDICT)?;
        let mut lights = Vec::with_capacity(count);
        let mut next = 0;
        for _ in 0..count {
            let (light, verdict) = self.light(&mut next, verdict::BITS)?;
            let proof = match verdict {
                verdict::UNOCCLUDED => Proof::Unoccluded,
                verdict::HIDDEN => Proof::Hidden,
                verdict::BEHIND => Proof::Behind(self.triangles()?),
                _ => Proof::Open,
            };
            lights.push((light, proof));
        }
        Ok(Region::new(bounds, lights))
    }

    /// A light, counted from the first that may come `next`, and the lowest bits beside it.
    fn light(&mut self, next: &mut u32, bits: u32) -> Result<(u32, u64), BytesError> {
        let number = self.bytes.number()?;
        let light = u64::from(*next).checked_add(number >> bits);
        let light = light.and_then(|light| u32::try_from(light).ok());
        let end = self.limits.map_or(u32::MAX, |limits| limits.lights);
        match light.filter(|&light| light < end) {
            Some(light) => {
                *next = light + 1;
                Ok((light, number & ((1 << bits) - 1)))
            }
            None => Err(BytesError::Malformed("there is no such light")),
        }
    }

    /// A list of what may be in the way: its length in bytes, and those.
    fn triangles(&mut self) -> Result<TriangleSet, BytesError> {
        let length = self.bytes.count(1)?;
        let packed = self.bytes.slice(length)?;
        let Some(limits) = self.limits else {
            return Ok(TriangleSet::from_own(packed));
        };
        let set = TriangleSet::from_any(packed, limits.triangles);
        set.ok_or(BytesError::Malformed("there is no such triangle"))
    }

    fn evidence(&mut self, light: u32) -> Result<LightEvidence, BytesError> {
        let bytes = &mut *self.bytes;
        let flags = bytes.byte()?;
        let is_set = |flag| flags & flag != 0;
        let mask = match (is_set(flag::LEFT_OUT), is_set(flag::WHOLE)) {
            (false, false) => None,
            (true, false) => Some(Mask::LeftOut),
            (false, true) => Some(Mask::Whole),
            (true, true) => return Err(BytesError::Malformed("a light has two masks")),
        };
        if flags & !flag::ALL != 0 {
            return Err(BytesError::Malformed("evidence of an unknown kind"));
        }
        let mut evidence = LightEvidence {
            inherited: is_set(flag::INHERITED),
            crowded: is_set(flag::CROWDED),
            mask,
            clear: bytes.small(RAYS)?,
            blocked: bytes.small(RAYS)?,
            agreed: bytes.small(RAYS)?,
            importance: bytes.byte()?,
            ..LightEvidence::new(light)
        };
        if is_set(flag::LUMINANCES) {
            evidence.most = self.luminance()?;
            evidence.withheld = self.luminance()?;
        }
        if is_set(flag::OCCLUDERS) {
            evidence.occluders = self.occluders()?;
        }
        Ok(evidence)
    }

    /// What was found in the way, in the order of its discovery.
    fn occluders(&mut self) -> Result<Vec<Occluder>, BytesError> {
        let end = self.limits.map_or(u32::MAX, |limits| limits.triangles);
        let count = self.bytes.count(1)?;
        let mut list = Vec::with_capacity(count);
        let mut before = 0;
        for _ in 0..count {
            let (triangle, is_confirmed) = self.bytes.difference(before, end)?;
            list.push(Occluder::new(triangle, is_confirmed));
            before = triangle;
        }
        Ok(list)
    }

    fn luminance(&mut self) -> Result<f32, BytesError> {
        let luminance = self.bytes.float()?;
        if self.limits.is_none() || luminance >= 0.0 {
            Ok(luminance)
        } else {
            Err(BytesError::Malformed("a luminance is not one"))
        }
    }
}
