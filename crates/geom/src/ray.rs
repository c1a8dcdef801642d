use glam::Vec3;

/// Where a shadow ray with direction `target − origin` ends: just before the target, so
/// that the light's own surface does not block it.
pub const SHADOW_T_MAX: f32 = 1.0 - 1.0e-4;

/// A ray, or a part of one: the points `origin + t · direction` with `t_min < t < t_max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start, in world space.
    pub origin: Vec3,
    /// Direction; any length but zero.
    pub direction: Vec3,
    /// Hits at or before this are ignored.
    pub t_min: f32,
    /// Hits at or after this are ignored.
    pub t_max: f32,
}

impl Ray {
    /// The whole ray, from its origin to infinity.
    #[must_use]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin,
            direction,
            t_min: 0.0,
            t_max: f32::INFINITY,
        }
    }

    /// The open segment between two points, ending just before `target`
    /// ([`SHADOW_T_MAX`]). Both ends should already be moved off their surfaces with
    /// [`offset_origin`].
    #[must_use]
    pub fn segment(origin: Vec3, target: Vec3) -> Self {
        Self {
            t_max: SHADOW_T_MAX,
            ..Self::new(origin, target - origin)
        }
    }

    /// The open segment of [`Self::segment`], seen from its other end: from just after
    /// `target` to `origin`. Many rays to a light without extent so have one origin, and a
    /// packet of them costs less.
    #[must_use]
    pub fn segment_from(target: Vec3, origin: Vec3) -> Self {
        Self {
            t_min: 1.0 - SHADOW_T_MAX,
            t_max: 1.0,
            ..Self::new(target, origin - target)
        }
    }

    /// Whether origin and direction are finite and the direction is not zero. A ray that is
    /// not defined hits nothing.
    #[must_use]
    #[inline]
    pub fn is_defined(&self) -> bool {
        self.origin.is_finite() && self.direction.is_finite() && self.direction != Vec3::ZERO
    }

    /// The point at `t`.
    #[must_use]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }
}

/// The closest intersection of a ray with the scene's triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter.
    pub t: f32,
    /// Barycentric weight of the triangle's second vertex.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex.
    pub v: f32,
    /// Index of the triangle in the scene.
    pub triangle: u32,
}

/// By how much [`offset_origin`] moves a point, in terms of coordinates and extent.
pub const OFFSET_ULPS: f32 = 16.0 * f32::EPSILON / 2.0;

/// Moves a point on a triangle off its plane, the way `towards` points, far enough that
/// rounding cannot let a ray from there hit the triangle or its coplanar neighbours.
/// `towards` is the unit normal, or has at least that component along it.
///
/// `extent` is the longest edge of the triangle in metres. The distance is 16 units in
/// the last place of the coordinates and the extent together: about 40 µm in a room of
/// 20 m. The triangle test's own error is a tenth of that.
#[must_use]
pub fn offset_origin(point: Vec3, towards: Vec3, extent: f32) -> Vec3 {
    let distance = OFFSET_ULPS * (point.abs().max_element() + extent);
    point + towards * distance
}
