//! `KHR_lights_punctual`.

use glam::{Mat4, Vec3};
use gltf::khr_lights_punctual::{self as punctual, Kind};

use super::{Document, node::label};
use crate::{Light, LightKind, draft::Draft, load::LoadError};

impl Document<'_> {
    /// Adds the light of a node. It shines along the node's −z; its intensity is not scaled.
    pub(super) fn add_light(
        &self,
        light: &punctual::Light<'_>,
        node: &gltf::Node<'_>,
        world_from_node: Mat4,
        draft: &mut Draft,
    ) -> Result<(), LoadError> {
        let element = || format!("light {} at {}", light.index(), label(node));
        let power = Vec3::from(light.color()) * light.intensity();
        if !(power.is_finite() && power.min_element() >= 0.0) {
            let problem = "expected a colour and an intensity that are finite and not negative";
            return Err(self.file.error(element(), problem));
        }
        if light.range().is_some() {
            draft
                .warnings
                .push("the range of lights is ignored: they reach everywhere".into());
        }
        let position = world_from_node.transform_point3(Vec3::ZERO);
        let direction = world_from_node
            .transform_vector3(Vec3::NEG_Z)
            .normalize_or(Vec3::NEG_Z);
        let kind = match light.kind() {
            Kind::Point => LightKind::Point {
                position,
                radiant_intensity: power,
            },
            Kind::Directional => LightKind::Directional {
                direction,
                irradiance: power,
            },
            Kind::Spot {
                inner_cone_angle: inner,
                outer_cone_angle: outer,
            } => {
                if !(inner >= 0.0
                    && inner <= outer
                    && outer <= std::f32::consts::FRAC_PI_2 + 1.0e-4)
                {
                    return Err(self.file.error(
                        element(),
                        format!(
                            "cone angles {inner} and {outer}: expected 0 ≤ inner ≤ outer ≤ π/2"
                        ),
                    ));
                }
                LightKind::Spot {
                    position,
                    direction,
                    radiant_intensity: power,
                    cos_inner: inner.cos(),
                    cos_outer: outer.cos(),
                }
            }
        };
        let name = node.name().or(light.name());
        draft.lights.push(Light {
            name: name.map_or_else(|| format!("light {}", draft.lights.len()), str::to_owned),
            kind,
        });
        Ok(())
    }

    /// Cones of lights that no node may use are checked too: the file is wrong either way.
    pub(super) fn check_lights(&self) -> Result<(), LoadError> {
        for light in self.gltf.lights().into_iter().flatten() {
            if let Kind::Spot {
                inner_cone_angle: inner,
                outer_cone_angle: outer,
            } = light.kind()
                && (inner >= outer || inner.is_nan() || outer.is_nan())
            {
                return Err(self.file.error(
                    format!("light {}", light.index()),
                    format!(
                        "expected innerConeAngle {inner} to be less than outerConeAngle {outer}"
                    ),
                ));
            }
        }
        Ok(())
    }
}
