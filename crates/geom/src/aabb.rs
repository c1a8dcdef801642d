use glam::Vec3;

/// An axis-aligned box; empty when any `min` exceeds its `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Aabb {
    /// The empty box: the neutral element of [`Self::union`].
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The smallest box around `points`; empty for none.
    pub fn around(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| Self {
            min: bounds.min.min(point),
            max: bounds.max.max(point),
        })
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// Whether no point is inside.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Edge lengths; zero for the empty box.
    #[must_use]
    pub fn size(self) -> Vec3 {
        if self.is_empty() {
            Vec3::ZERO
        } else {
            self.max - self.min
        }
    }

    /// The middle; the origin for the empty box.
    #[must_use]
    pub fn center(self) -> Vec3 {
        if self.is_empty() {
            Vec3::ZERO
        } else {
            self.min + 0.5 * (self.max - self.min)
        }
    }

    /// Whether `point` lies inside or on the surface.
    #[must_use]
    pub fn contains(self, point: Vec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_box_is_neutral_and_has_no_size() {
        let unit = Aabb {
            min: Vec3::ZERO,
            max: Vec3::ONE,
        };
        assert_eq!(Aabb::EMPTY.union(unit), unit);
        assert_eq!(Aabb::EMPTY.size(), Vec3::ZERO);
        assert_eq!(Aabb::around([]), Aabb::EMPTY);
        assert!(Aabb::EMPTY.is_empty() && !unit.is_empty());
        assert!(unit.contains(Vec3::ONE) && !Aabb::EMPTY.contains(Vec3::ZERO));
    }
}
