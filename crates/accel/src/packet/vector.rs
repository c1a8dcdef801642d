//! Numbers in vectors. A kernel is written once, for whatever vector unit its [`Simd`] token
//! stands for, and [`on_vectors!`](super::on_vectors) chooses one at run time.

#[cfg(not(any(test, feature = "choose-unit")))]
use fearless_simd::Level;
use fearless_simd::{f32x16, mask32x16, prelude::*};

use super::Lanes;

/// One number for each ray.
pub(crate) type Wide<S> = f32x16<S>;

/// One bit for each ray.
pub(crate) type WideMask<S> = mask32x16<S>;

/// Calls a kernel on the machine's widest vectors: `on_vectors!(simd => kernel(simd, …))`. All
/// that the kernel calls must be `#[inline(always)]`, or it is compiled without them.
macro_rules! on_vectors {
    ($simd:ident => $kernel:expr) => {{
        #[allow(clippy::redundant_closure_call, reason = "of the macro's making")]
        let found = fearless_simd::dispatch!($crate::packet::vector::unit(), $simd => $kernel);
        found
    }};
}
pub(crate) use on_vectors;

/// The vector unit that kernels run on.
#[cfg(not(any(test, feature = "choose-unit")))]
#[inline]
pub(crate) fn unit() -> Level {
    Level::new()
}

#[cfg(test)]
pub(crate) use crate::vector_unit::on_each_unit;
#[cfg(any(test, feature = "choose-unit"))]
pub(crate) use crate::vector_unit::unit;

/// Numbers from memory.
#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, lanes: &Lanes) -> Wide<S> {
    Wide::simd_from(simd, *lanes)
}

/// Three coordinates from memory.
#[inline(always)]
pub(crate) fn load_axes<S: Simd, V: SimdFloat<S>>(simd: S, axes: &[V::Array; 3]) -> [V; 3] {
    [
        V::simd_from(simd, axes[0]),
        V::simd_from(simd, axes[1]),
        V::simd_from(simd, axes[2]),
    ]
}

/// Three coordinates, the same in all lanes.
#[inline(always)]
pub(crate) fn splat_axes<S: Simd, V: SimdFloat<S, Element = f32>>(
    simd: S,
    axes: [f32; 3],
) -> [V; 3] {
    [
        V::splat(simd, axes[0]),
        V::splat(simd, axes[1]),
        V::splat(simd, axes[2]),
    ]
}

/// The lanes of a set of bits.
#[inline(always)]
pub(crate) fn mask_of<S: Simd>(simd: S, bits: u32) -> WideMask<S> {
    WideMask::from_bitmask(simd, u64::from(bits))
}

/// Bit `i` for lane `i`.
#[inline(always)]
pub(crate) fn bits_of<S: Simd>(mask: WideMask<S>) -> u32 {
    mask.to_bitmask() as u32
}

/// The least and the largest number of some lanes; infinite, and the wrong way round, if there
/// are none.
#[inline(always)]
pub(crate) fn extremes<S: Simd>(simd: S, values: Wide<S>, lanes: WideMask<S>) -> [f32; 2] {
    let least = lanes.select(values, Wide::splat(simd, f32::INFINITY));
    let most = lanes.select(values, Wide::splat(simd, f32::NEG_INFINITY));
    [least.reduce_min(), most.reduce_max()]
}
