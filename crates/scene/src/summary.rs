use std::fmt;

use glam::Vec3;
use lie_geom::Aabb;

use crate::{LightKind, Scene};

/// What there is in a scene: counts, sizes, names. [`fmt::Display`] writes a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The scene's name.
    pub name: String,
    /// Number of triangles.
    pub triangles: usize,
    /// Number of vertices.
    pub vertices: usize,
    /// Number of mesh parts.
    pub parts: usize,
    /// Bounds of all triangles, in metres; empty without any.
    pub bounds: Aabb,
    /// Number of materials, and how many of them cut holes or give off light.
    pub materials: MaterialCounts,
    /// Number of textures.
    pub textures: usize,
    /// Bytes that the textures' texels take.
    pub texture_bytes: usize,
    /// Each kind of light there is.
    pub lights: Vec<LightSummary>,
    /// Name and vertical field of view in degrees of each camera.
    pub cameras: Vec<(String, f32)>,
    /// Name, duration in seconds and number of key frames of each walkthrough.
    pub walkthroughs: Vec<(String, f32, usize)>,
}

/// Materials by what they do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MaterialCounts {
    /// All of them.
    pub all: usize,
    /// Those that cut holes.
    pub masked: usize,
    /// Those that give off light.
    pub emissive: usize,
}

/// All lights of a kind.
#[derive(Clone, Debug, PartialEq)]
pub struct LightSummary {
    /// `point`, `spot`, `directional`, `rectangle` or `mesh`.
    pub kind: &'static str,
    /// How many.
    pub count: usize,
    /// Their power together in W per channel; for directional lights the irradiance.
    pub power: Vec3,
}

impl Summary {
    /// Counts what is in `scene`.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let materials = &scene.materials;
        Self {
            name: scene.name.clone(),
            triangles: scene.geometry.len(),
            vertices: scene.geometry.vertices().len(),
            parts: scene.geometry.parts().len(),
            bounds: scene.geometry.bounds(),
            materials: MaterialCounts {
                all: materials.len(),
                masked: materials
                    .iter()
                    .filter(|material| material.is_masked())
                    .count(),
                emissive: materials
                    .iter()
                    .filter(|material| material.is_emissive())
                    .count(),
            },
            textures: scene.textures.len(),
            texture_bytes: scene
                .textures
                .iter()
                .map(|texture| size_of_val(texture.texels()))
                .sum(),
            lights: light_summaries(scene),
            cameras: scene
                .cameras
                .iter()
                .map(|camera| (camera.name.clone(), camera.vertical_fov.to_degrees()))
                .collect(),
            walkthroughs: scene
                .walkthroughs
                .iter()
                .map(|walk| (walk.name.clone(), walk.duration_s(), walk.key_frames.len()))
                .collect(),
        }
    }

    /// Number of lights of all kinds.
    #[must_use]
    pub fn light_count(&self) -> usize {
        self.lights.iter().map(|lights| lights.count).sum()
    }
}

fn light_summaries(scene: &Scene) -> Vec<LightSummary> {
    ["point", "spot", "directional", "rectangle", "mesh"]
        .into_iter()
        .map(|kind| {
            let of_kind = scene
                .lights
                .iter()
                .filter(|light| kind_name(&light.kind) == kind);
            LightSummary {
                kind,
                count: of_kind.clone().count(),
                power: of_kind.map(crate::Light::power).sum(),
            }
        })
        .filter(|lights| lights.count > 0)
        .collect()
}

fn kind_name(kind: &LightKind) -> &'static str {
    match kind {
        LightKind::Point { .. } => "point",
        LightKind::Spot { .. } => "spot",
        LightKind::Directional { .. } => "directional",
        LightKind::Area(area) => match area.shape() {
            crate::AreaShape::Rectangle { .. } => "rectangle",
            crate::AreaShape::Mesh { .. } => "mesh",
        },
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut row = |key: &str, value: String| writeln!(f, "{key:<12} {value}");
        row("scene", self.name.clone())?;
        row(
            "geometry",
            format!(
                "{} triangles, {} vertices, {} parts",
                self.triangles, self.vertices, self.parts
            ),
        )?;
        if self.bounds.is_empty() {
            row("bounds", "none".into())?;
        } else {
            let (min, max, size) = (self.bounds.min, self.bounds.max, self.bounds.size());
            row(
                "bounds",
                format!(
                    "{min:.2} to {max:.2}, {:.2} × {:.2} × {:.2} m",
                    size.x, size.y, size.z
                ),
            )?;
        }
        let MaterialCounts {
            all,
            masked,
            emissive,
        } = self.materials;
        row(
            "materials",
            format!("{all} ({masked} masked, {emissive} emissive)"),
        )?;
        let mebibytes = self.texture_bytes as f64 / f64::from(1 << 20);
        row(
            "textures",
            format!("{} ({mebibytes:.1} MiB)", self.textures),
        )?;
        row("lights", self.light_count().to_string())?;
        for LightSummary { kind, count, power } in &self.lights {
            let unit = if *kind == "directional" { "W/m²" } else { "W" };
            row(
                &format!("  {kind}"),
                format!("{count:>4}, {power:.1} {unit}"),
            )?;
        }
        for (name, degrees) in &self.cameras {
            row("camera", format!("'{name}', {degrees:.1}° high"))?;
        }
        for (name, duration_s, key_frames) in &self.walkthroughs {
            row(
                "walkthrough",
                format!("'{name}', {duration_s:.1} s, {key_frames} key frames"),
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cornell_box_in_figures() {
        let summary = Summary::new(&crate::cornell_box());
        assert_eq!((summary.triangles, summary.light_count()), (36, 1));
        assert_eq!(summary.lights[0].kind, "rectangle");
        let table = summary.to_string();
        for piece in [
            "36 triangles",
            "rectangle",
            "'front'",
            "5.50 × 5.50 × 5.60 m",
        ] {
            assert!(table.contains(piece), "{piece} is in\n{table}");
        }
    }

    #[test]
    fn nothing_is_nothing() {
        let scene = Scene {
            geometry: crate::Geometry::default(),
            lights: vec![],
            ..crate::cornell_box()
        };
        assert!(
            Summary::new(&scene)
                .to_string()
                .contains("bounds       none")
        );
    }
}
