use glam::{Quat, Vec3};
use serde_json::{Value, json};

use super::{
    ExportError, Exported, emission::lights_without_surface, glb_binary::Glb, glb_material,
};
use crate::{Camera, Light, LightKind, MeshPart, Scene};

/// Writes a scene as binary glTF 2.0: one mesh per part, lights as `KHR_lights_punctual`,
/// emissive surfaces, cameras, textures as PNG.
///
/// Loading it again gives the same triangles, materials, lights and cameras, up to rounding.
/// Walkthroughs, background and settings have no place in the format.
///
/// # Errors
/// [`ExportError`]; nothing is left out silently.
pub fn export_glb(scene: &Scene) -> Result<Exported<Vec<u8>>, ExportError> {
    let mut glb = Glb::default();
    let mut warnings = lost(scene);
    let materials = glb_material::materials(scene, &mut glb)?;
    let mut document = glb_material::Document::new(materials);
    for part in scene.geometry.parts() {
        if !part.triangles.is_empty() {
            glb.add_part(scene, part, &mut document);
        }
    }
    for (index, area) in lights_without_surface(scene) {
        let name = &scene.lights[index].name;
        warnings.push(format!(
            "area light '{name}' had no surface of its own; in the file it has"
        ));
        let material = glb_material::emissive(name, area);
        let mesh = glb.add_triangles(area, document.add_material(material));
        document.add_mesh(name, mesh);
    }
    for light in &scene.lights {
        if let Some((punctual, node)) = punctual(light) {
            document.add_light(punctual, node);
        }
    }
    for camera in &scene.cameras {
        document.add_camera(
            camera_json(camera),
            node(&camera.name, camera.eye, camera.orientation),
        );
    }
    let content = glb.finish(document.into_json())?;
    Ok(Exported { content, warnings })
}

/// Narrowest cone that is written, in radians: its cosine is 1 in single precision.
const MIN_CONE: f64 = 1.0e-4;

/// What glTF has no place for.
fn lost(scene: &Scene) -> Vec<String> {
    let mut warnings = Vec::new();
    if !scene.walkthroughs.is_empty() {
        warnings.push("walkthroughs are not written: keep them in a scene.toml".into());
    }
    if scene.background.radiance != Vec3::ZERO {
        warnings.push("the background is not written: keep it in a scene.toml".into());
    }
    let is_wide = |light: &&Light| matches!(light.kind, LightKind::Spot { cos_outer, .. } if cos_outer < -1.0e-4);
    for light in scene.lights.iter().filter(is_wide) {
        let name = &light.name;
        warnings.push(format!(
            "spot '{name}' is wider than 90° from its axis; in the file it is not"
        ));
    }
    warnings
}

fn node(name: &str, translation: Vec3, rotation: Quat) -> Value {
    json!({
        "name": name,
        "translation": translation.to_array(),
        "rotation": rotation.to_array(),
    })
}

/// The rotation that carries −z along `direction`.
fn towards(direction: Vec3) -> Quat {
    Quat::from_rotation_arc(Vec3::NEG_Z, direction.normalize_or(Vec3::NEG_Z)).normalize()
}

fn punctual(light: &Light) -> Option<(Value, Value)> {
    // Powers above 1 go into the intensity: the standard wants colours within 0 to 1.
    let power = |power: Vec3| {
        let strength = power.max_element();
        let color = if strength > 0.0 {
            power / strength
        } else {
            Vec3::ONE
        };
        (color.to_array(), strength)
    };
    let name = light.name.as_str();
    match &light.kind {
        LightKind::Point {
            position,
            radiant_intensity,
        } => {
            let (color, intensity) = power(*radiant_intensity);
            let light =
                json!({"type": "point", "name": name, "color": color, "intensity": intensity});
            Some((light, node(name, *position, Quat::IDENTITY)))
        }
        LightKind::Spot {
            position,
            direction,
            radiant_intensity,
            cos_inner,
            cos_outer,
        } => {
            let (color, intensity) = power(*radiant_intensity);
            // An acos near 1 is coarse in single precision.
            let angle = |cosine: &f32| f64::from(*cosine).acos();
            // The standard wants the inner angle strictly within the outer one, and that
            // within a right angle.
            let (inner, outer) = (angle(cos_inner), angle(cos_outer));
            let outer = outer.clamp(MIN_CONE, std::f64::consts::FRAC_PI_2);
            let inner = inner.min(outer * (1.0 - 1.0e-6));
            let light = json!({
                "type": "spot", "name": name, "color": color, "intensity": intensity,
                "spot": {"innerConeAngle": inner, "outerConeAngle": outer},
            });
            Some((light, node(name, *position, towards(*direction))))
        }
        LightKind::Directional {
            direction,
            irradiance,
        } => {
            let (color, intensity) = power(*irradiance);
            let light = json!({"type": "directional", "name": name, "color": color, "intensity": intensity});
            Some((light, node(name, Vec3::ZERO, towards(*direction))))
        }
        LightKind::Area(_) => None,
    }
}

fn camera_json(camera: &Camera) -> Value {
    json!({
        "type": "perspective",
        "name": camera.name,
        "perspective": {"yfov": camera.vertical_fov, "znear": 0.01},
    })
}

impl Glb {
    /// Adds a part with the vertices it uses.
    fn add_part(&mut self, scene: &Scene, part: &MeshPart, document: &mut glb_material::Document) {
        let range = part.triangles.start as usize..part.triangles.end as usize;
        let triangles = &scene.geometry.triangles()[range];
        let mut own = std::collections::HashMap::new();
        let mut used = Vec::new();
        let indices: Vec<u32> = triangles
            .iter()
            .flatten()
            .map(|&index| {
                *own.entry(index).or_insert_with(|| {
                    used.push(scene.geometry.vertices()[index as usize]);
                    used.len() as u32 - 1
                })
            })
            .collect();
        let positions: Vec<Vec3> = used.iter().map(|vertex| vertex.position).collect();
        let mut attributes = json!({"POSITION": self.add_positions(&positions)});
        // Without the attribute shading is flat, which a zero normal means here.
        if used.iter().any(|vertex| vertex.normal != Vec3::ZERO) {
            let normals = used.iter().flat_map(|vertex| vertex.normal.to_array());
            attributes["NORMAL"] = json!(self.add_floats("VEC3", used.len(), normals));
        }
        if used.iter().any(|vertex| vertex.uv != glam::Vec2::ZERO) {
            let uvs = used.iter().flat_map(|vertex| vertex.uv.to_array());
            attributes["TEXCOORD_0"] = json!(self.add_floats("VEC2", used.len(), uvs));
        }
        let indices = self.add_indices(&indices);
        document.add_mesh(
            &part.name,
            json!({"attributes": attributes, "indices": indices, "material": part.material}),
        );
    }

    /// Adds an area light's own triangles as a primitive.
    fn add_triangles(&mut self, area: &crate::AreaLight, material: usize) -> Value {
        let corners = area
            .triangles()
            .iter()
            .flat_map(|triangle| [triangle.a, triangle.b, triangle.c]);
        let positions: Vec<Vec3> = corners.collect();
        json!({"attributes": {"POSITION": self.add_positions(&positions)}, "material": material})
    }
}
