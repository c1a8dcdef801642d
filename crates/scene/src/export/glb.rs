use glam::{Quat, Vec3};
use serde_json::{Value, json};

use super::{ExportError, Exported, emission::lights_without_surface, glb_material};
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

/// The binary chunk, with the views and accessors into it.
#[derive(Default)]
pub(super) struct Glb {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

impl Glb {
    /// Adds bytes as a view, at a multiple of four, and gives its index.
    pub(super) fn add_view(&mut self, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(json!({
            "buffer": 0,
            "byteOffset": self.bytes.len(),
            "byteLength": bytes.len(),
        }));
        self.bytes.extend_from_slice(bytes);
        self.views.len() - 1
    }

    fn add_floats(
        &mut self,
        kind: &str,
        count: usize,
        numbers: impl Iterator<Item = f32>,
    ) -> usize {
        let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
        let view = self.add_view(&bytes);
        self.accessors.push(json!({
            "bufferView": view, "componentType": FLOAT, "count": count, "type": kind,
        }));
        self.accessors.len() - 1
    }

    fn add_positions(&mut self, positions: &[Vec3]) -> usize {
        let numbers = positions.iter().flat_map(|position| position.to_array());
        let accessor = self.add_floats("VEC3", positions.len(), numbers);
        let bounds = lie_geom::Aabb::around(positions.iter().copied());
        self.accessors[accessor]["min"] = json!(bounds.min.to_array());
        self.accessors[accessor]["max"] = json!(bounds.max.to_array());
        accessor
    }

    fn add_indices(&mut self, indices: &[u32]) -> usize {
        let bytes: Vec<u8> = indices
            .iter()
            .flat_map(|index| index.to_le_bytes())
            .collect();
        let view = self.add_view(&bytes);
        self.accessors.push(json!({
            "bufferView": view, "componentType": UNSIGNED_INT, "count": indices.len(), "type": "SCALAR",
        }));
        self.accessors.len() - 1
    }

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

    /// The file: header, JSON chunk padded with spaces, binary chunk padded with zeros.
    fn finish(mut self, mut document: Value) -> Result<Vec<u8>, ExportError> {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        if !self.bytes.is_empty() {
            document["buffers"] = json!([{"byteLength": self.bytes.len()}]);
            document["bufferViews"] = Value::Array(self.views);
            document["accessors"] = Value::Array(self.accessors);
        }
        let mut text = serde_json::to_vec(&document)?;
        text.resize(text.len().next_multiple_of(4), b' ');
        let total = 12 + 8 + text.len() as u64 + 8 + self.bytes.len() as u64;
        let length = u32::try_from(total).map_err(|_| ExportError::TooLarge(total))?;
        let mut file = Vec::with_capacity(total as usize);
        file.extend_from_slice(b"glTF");
        file.extend_from_slice(&2u32.to_le_bytes());
        file.extend_from_slice(&length.to_le_bytes());
        for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &self.bytes)] {
            file.extend_from_slice(&(chunk.len() as u32).to_le_bytes());
            file.extend_from_slice(kind);
            file.extend_from_slice(chunk);
        }
        Ok(file)
    }
}
