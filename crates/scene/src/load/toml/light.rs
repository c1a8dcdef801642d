//! `[[light]]`.

use glam::{Vec2, Vec3};
use toml::Spanned;

use super::{
    geometry::no_such_material,
    schema::{LightEntry, Problem},
};
use crate::{
    AreaLight, AreaShape, Light, LightKind, Material, Vertex,
    draft::{Draft, DraftPart},
};

/// Adds the light that an entry describes.
pub(super) fn add(entry: &Spanned<LightEntry>, draft: &mut Draft) -> Result<(), Problem> {
    let light = entry.as_ref();
    let reader = Reader { entry, light };
    if let Some(name) = &light.emissive_material {
        reader.only(&["emissive_material", "radiance", "double_sided"])?;
        return make_emissive(name, reader.power("radiance")?, light.double_sided, draft);
    }
    let Some(kind) = &light.kind else {
        return Err(reader.problem("expected a kind, or an emissive_material"));
    };
    let name = light
        .name
        .clone()
        .unwrap_or_else(|| format!("light {}", draft.lights.len()));
    let kind = match kind.as_ref().as_str() {
        "point" => {
            reader.only(&["radiant_intensity", "position"])?;
            LightKind::Point {
                position: reader.point("position")?,
                radiant_intensity: reader.power("radiant_intensity")?,
            }
        }
        "spot" => {
            reader.only(&[
                "radiant_intensity",
                "position",
                "target",
                "direction",
                "inner_degrees",
                "outer_degrees",
            ])?;
            reader.spot()?
        }
        "directional" => {
            reader.only(&["irradiance", "position", "target", "direction"])?;
            LightKind::Directional {
                direction: reader.direction()?,
                irradiance: reader.power("irradiance")?,
            }
        }
        "rectangle" => {
            reader.only(&[
                "radiance",
                "position",
                "target",
                "direction",
                "size_m",
                "up",
                "corner",
                "edge_u",
                "edge_v",
                "double_sided",
                "visible",
            ])?;
            let (shape, radiance) = (reader.rectangle()?, reader.power("radiance")?);
            let double_sided = light.double_sided.unwrap_or(false);
            if light.visible.unwrap_or(true) {
                add_visible(&name, &shape, radiance, double_sided, draft);
                return Ok(());
            }
            LightKind::Area(AreaLight::new(shape, radiance, double_sided))
        }
        other => {
            let expected =
                "expected the kind \"point\", \"spot\", \"directional\" or \"rectangle\"";
            return Err((
                kind.span(),
                format!(
                    "{expected}, found \"{}\"",
                    crate::load::source::shorten(other)
                ),
            ));
        }
    };
    draft.lights.push(Light { name, kind });
    Ok(())
}

/// Lets all materials of a name shine.
fn make_emissive(
    name: &Spanned<String>,
    radiance: Vec3,
    double_sided: Option<bool>,
    draft: &mut Draft,
) -> Result<(), Problem> {
    let wanted = name.as_ref();
    let mut found = false;
    for material in draft
        .materials
        .iter_mut()
        .filter(|material| material.name == *wanted)
    {
        found = true;
        material.emission = radiance;
        material.double_sided = double_sided.unwrap_or(material.double_sided);
    }
    if found {
        Ok(())
    } else {
        Err((name.span(), no_such_material(wanted, draft)))
    }
}

/// A rectangle that is seen: two emissive triangles, from which the light follows.
fn add_visible(
    name: &str,
    shape: &AreaShape,
    radiance: Vec3,
    double_sided: bool,
    draft: &mut Draft,
) {
    let AreaShape::Rectangle {
        corner,
        edge_u,
        edge_v,
    } = *shape
    else {
        return;
    };
    let material = draft.add_material(Material {
        emission: radiance,
        double_sided,
        ..Material::diffuse(name, Vec3::splat(0.8))
    });
    let vertex = |u: f32, v: f32| Vertex {
        position: corner + u * edge_u + v * edge_v,
        normal: Vec3::ZERO,
        uv: Vec2::new(u, v),
    };
    draft.add_part(DraftPart {
        name: name.to_owned(),
        vertices: vec![
            vertex(0.0, 0.0),
            vertex(1.0, 0.0),
            vertex(1.0, 1.0),
            vertex(0.0, 1.0),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material,
    });
}

/// Takes the fields of one light, or says which is missing.
struct Reader<'a> {
    entry: &'a Spanned<LightEntry>,
    light: &'a LightEntry,
}

impl Reader<'_> {
    fn problem(&self, problem: &str) -> Problem {
        (self.entry.span(), problem.to_owned())
    }

    /// Refuses fields that this kind of light does not have.
    fn only(&self, allowed: &[&str]) -> Result<(), Problem> {
        let light = self.light;
        let given = [
            ("radiant_intensity", light.radiant_intensity.is_some()),
            ("radiance", light.radiance.is_some()),
            ("irradiance", light.irradiance.is_some()),
            ("position", light.position.is_some()),
            ("target", light.target.is_some()),
            ("direction", light.direction.is_some()),
            ("inner_degrees", light.inner_degrees.is_some()),
            ("outer_degrees", light.outer_degrees.is_some()),
            ("size_m", light.size_m.is_some()),
            ("up", light.up.is_some()),
            ("corner", light.corner.is_some()),
            ("edge_u", light.edge_u.is_some()),
            ("edge_v", light.edge_v.is_some()),
            ("double_sided", light.double_sided.is_some()),
            ("visible", light.visible.is_some()),
            ("emissive_material", light.emissive_material.is_some()),
        ];
        match given
            .iter()
            .find(|(name, given)| *given && !allowed.contains(name))
        {
            Some((name, _)) => {
                let allowed = allowed.join(", ");
                Err(self.problem(&format!(
                    "this kind of light has no {name}; expected {allowed}"
                )))
            }
            None => Ok(()),
        }
    }

    fn power(&self, name: &str) -> Result<Vec3, Problem> {
        let power = match name {
            "radiance" => self.light.radiance,
            "irradiance" => self.light.irradiance,
            _ => self.light.radiant_intensity,
        };
        power
            .map(|power| power.0)
            .ok_or_else(|| self.problem(&format!("the light needs a {name}")))
    }

    fn point(&self, name: &str) -> Result<Vec3, Problem> {
        let point = match name {
            "corner" => self.light.corner,
            "edge_u" => self.light.edge_u,
            "edge_v" => self.light.edge_v,
            _ => self.light.position,
        };
        point
            .map(|point| point.0)
            .ok_or_else(|| self.problem(&format!("the light needs a {name}")))
    }

    /// The unit vector along `direction`, or from `position` to `target`.
    fn direction(&self) -> Result<Vec3, Problem> {
        let along = match (self.light.direction, self.light.target) {
            (Some(direction), None) => direction.0,
            (None, Some(target)) => target.0 - self.point("position")?,
            _ => return Err(self.problem("the light needs either a direction or a target")),
        };
        along
            .try_normalize()
            .ok_or_else(|| self.problem("the light's direction has no length"))
    }

    fn spot(&self) -> Result<LightKind, Problem> {
        let outer = self.light.outer_degrees.unwrap_or(45.0);
        let inner = self.light.inner_degrees.unwrap_or(0.0);
        if !(0.0 <= inner && inner <= outer && outer <= 90.0 && outer > 0.0) {
            return Err(self.problem("expected 0 <= inner_degrees <= outer_degrees <= 90"));
        }
        Ok(LightKind::Spot {
            position: self.point("position")?,
            direction: self.direction()?,
            radiant_intensity: self.power("radiant_intensity")?,
            cos_inner: inner.to_radians().cos(),
            cos_outer: outer.to_radians().cos(),
        })
    }

    /// From a corner and two edges, or around a position with a size.
    fn rectangle(&self) -> Result<AreaShape, Problem> {
        let (corner, edge_u, edge_v) = if self.light.corner.is_some() {
            if self.light.position.is_some() || self.light.size_m.is_some() {
                return Err(
                    self.problem("expected either corner with edges, or position with size_m")
                );
            }
            (
                self.point("corner")?,
                self.point("edge_u")?,
                self.point("edge_v")?,
            )
        } else {
            let Some(size) = self.light.size_m else {
                return Err(self.problem(
                    "a rectangle needs corner, edge_u and edge_v, or position and size_m",
                ));
            };
            let normal = self.direction()?;
            let up = self.light.up.map_or(Vec3::Y, |up| up.0);
            let across = up.cross(normal).try_normalize().unwrap_or_else(|| {
                // A ceiling or floor light: its width lies along x.
                Vec3::Z.cross(normal).normalize_or(Vec3::X)
            });
            let (edge_u, edge_v) = (size.0.x * across, size.0.y * normal.cross(across));
            (
                self.point("position")? - 0.5 * (edge_u + edge_v),
                edge_u,
                edge_v,
            )
        };
        if edge_u.cross(edge_v).length_squared() > 0.0 {
            Ok(AreaShape::Rectangle {
                corner,
                edge_u,
                edge_v,
            })
        } else {
            Err(self.problem("the rectangle has no area"))
        }
    }
}
