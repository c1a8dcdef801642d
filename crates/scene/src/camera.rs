use glam::{Quat, UVec2, Vec2, Vec3};
use lie_geom::Ray;
use multiversion::multiversion;

use crate::{
    SURFACE_LANES,
    surface_lanes::{Lanes, unit_or},
};

/// A pinhole camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Name to call it by.
    pub name: String,
    /// The pinhole, in world space.
    pub eye: Vec3,
    /// World from camera: the camera looks along −z, with +x to the right and +y up.
    pub orientation: Quat,
    /// Vertical field of view in radians, in `(0, π)`.
    pub vertical_fov: f32,
}

impl Camera {
    /// A camera at `eye` that looks at `target`. A target at the eye looks along −z; an
    /// `up` along the view is replaced by another axis.
    #[must_use]
    pub fn look_at(
        name: impl Into<String>,
        eye: Vec3,
        target: Vec3,
        up: Vec3,
        vertical_fov: f32,
    ) -> Self {
        Self {
            name: name.into(),
            eye,
            orientation: orientation_towards(target - eye, up),
            vertical_fov,
        }
    }

    /// The ray through a point of the film: (0, 0) is the upper left corner, `size` the
    /// lower right one. Its direction has unit length.
    #[must_use]
    pub fn ray(&self, film: Vec2, size: UVec2) -> Ray {
        self.film(size).ray(film)
    }

    /// The film of a picture of this many columns and rows.
    #[must_use]
    pub fn film(&self, size: UVec2) -> CameraFilm {
        CameraFilm {
            eye: self.eye,
            right: self.orientation * Vec3::X,
            up: self.orientation * Vec3::Y,
            back: self.orientation * Vec3::Z,
            half_height: (0.5 * self.vertical_fov).tan(),
            size: size.as_vec2(),
        }
    }

    /// Where the camera looks; unit length.
    #[must_use]
    pub fn forward(&self) -> Vec3 {
        self.orientation * Vec3::NEG_Z
    }

    /// Whether every number is finite, the orientation a rotation and the field of view possible.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.eye.is_finite()
            && self.orientation.is_finite()
            && self.orientation.is_normalized()
            && self.vertical_fov > 0.0
            && self.vertical_fov < std::f32::consts::PI
    }
}

/// A camera's film: what all rays of a picture have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraFilm {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    back: Vec3,
    /// Of the film at distance 1.
    half_height: f32,
    size: Vec2,
}

impl CameraFilm {
    /// [`Camera::ray`].
    #[must_use]
    #[inline]
    pub fn ray(&self, film: Vec2) -> Ray {
        let x = (2.0 * film.x - self.size.x) / self.size.y * self.half_height;
        let y = (self.size.y - 2.0 * film.y) / self.size.y * self.half_height;
        let direction = self.right * x + self.up * y - self.back;
        Ray::new(self.eye, direction.normalize_or(Vec3::NEG_Z))
    }

    /// Where all rays start.
    #[must_use]
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// The directions of [`Self::ray`] through sixteen points of the film, given by axis: the same bits.
    #[must_use]
    pub fn directions(&self, film: &[Lanes; 2]) -> [Lanes; 3] {
        directions(self, film)
    }
}

#[multiversion(targets(
    "x86_64+avx512f+avx512vl+avx512dq+avx512bw+bmi1+bmi2+popcnt+lzcnt",
    "x86_64+avx2+bmi1+bmi2+popcnt+lzcnt"
))]
fn directions(camera: &CameraFilm, film: &[Lanes; 2]) -> [Lanes; 3] {
    let [right, up, back] = [camera.right, camera.up, camera.back].map(|axis| axis.to_array());
    let mut directions = [[0.0; SURFACE_LANES]; 3];
    for lane in 0..SURFACE_LANES {
        let (width, height) = (camera.size.x, camera.size.y);
        let x = (2.0 * film[0][lane] - width) / height * camera.half_height;
        let y = (height - 2.0 * film[1][lane]) / height * camera.half_height;
        let mut way = [0.0; 3];
        for axis in 0..3 {
            way[axis] = right[axis] * x + up[axis] * y - back[axis];
        }
        let way = unit_or(way, [0.0, 0.0, -1.0]);
        for axis in 0..3 {
            directions[axis][lane] = way[axis];
        }
    }
    directions
}

/// The rotation that turns −z towards `forward` and keeps +y near `up`.
pub(crate) fn orientation_towards(forward: Vec3, up: Vec3) -> Quat {
    let back = -forward.normalize_or(Vec3::NEG_Z);
    let right = up
        .cross(back)
        .try_normalize()
        .unwrap_or_else(|| back.any_orthonormal_vector());
    Quat::from_mat3(&glam::Mat3::from_cols(right, back.cross(right), back)).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_the_corners_of_the_film() {
        let fov = std::f32::consts::FRAC_PI_2;
        let camera = Camera::look_at("test", Vec3::Y, Vec3::new(0.0, 1.0, -5.0), Vec3::Y, fov);
        let size = UVec2::new(200, 100);
        let middle = camera.ray(Vec2::new(100.0, 50.0), size);
        assert!((middle.direction - Vec3::NEG_Z).length() < 1.0e-6);
        let corner = camera.ray(Vec2::ZERO, size).direction;
        assert!((corner / -corner.z - Vec3::new(-2.0, 1.0, -1.0)).length() < 1.0e-5);
    }

    #[test]
    fn directions_are_those_of_the_rays() {
        let camera = Camera::look_at("test", Vec3::Y, Vec3::new(3.0, 2.0, -5.0), Vec3::Y, 1.1);
        let film = camera.film(UVec2::new(90, 70));
        let place = |lane: usize| Vec2::new(5.7 * lane as f32, 70.0 - 4.1 * lane as f32);
        let places = [0, 1].map(|axis| std::array::from_fn(|lane| place(lane)[axis]));
        let directions = film.directions(&places);
        for lane in 0..SURFACE_LANES {
            let found = Vec3::from(directions.map(|axis| axis[lane]));
            assert_eq!(found, film.ray(place(lane)).direction);
        }
    }

    #[test]
    fn looking_along_up_or_nowhere_still_gives_a_rotation() {
        for (target, up) in [
            (Vec3::Y, Vec3::Y),
            (Vec3::ZERO, Vec3::Y),
            (Vec3::X, Vec3::ZERO),
        ] {
            let camera = Camera::look_at("test", Vec3::ZERO, target, up, 1.0);
            assert!(camera.is_valid());
            assert!(camera.forward().dot(target.normalize_or(Vec3::NEG_Z)) > 0.9999);
        }
    }
}
