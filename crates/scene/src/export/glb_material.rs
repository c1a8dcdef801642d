//! glTF's JSON: materials, textures, and the lists that nodes refer to.

use std::io::Cursor;

use glam::Vec3;
use image::{ImageFormat, RgbaImage};
use serde_json::{Value, json};

use super::{ExportError, glb_binary::Glb};
use crate::{AlphaMode, AreaLight, Material, Scene, Texture, TextureRef};

/// Materials, textures and images of a scene.
pub(super) struct Materials {
    materials: Vec<Value>,
    images: Vec<Value>,
}

/// Encodes all materials and textures. A texture is an image of the same index.
pub(super) fn materials(scene: &Scene, glb: &mut Glb) -> Result<Materials, ExportError> {
    let images = scene
        .textures
        .iter()
        .enumerate()
        .map(|(index, texture)| {
            let png = encode(texture).map_err(|source| ExportError::Texture {
                texture: index,
                source,
            })?;
            Ok(json!({"bufferView": glb.add_view(&png), "mimeType": "image/png"}))
        })
        .collect::<Result<_, ExportError>>()?;
    Ok(Materials {
        materials: scene.materials.iter().map(material).collect(),
        images,
    })
}

/// The material of an area light that had no surface.
pub(super) fn emissive(name: &str, area: &AreaLight) -> Value {
    material(&Material {
        emission: area.radiance,
        double_sided: area.double_sided,
        ..Material::diffuse(name, Vec3::splat(0.8))
    })
}

fn encode(texture: &Texture) -> Result<Vec<u8>, image::ImageError> {
    let bytes = texture.texels().iter().flatten().copied().collect();
    let mut png = Cursor::new(Vec::new());
    if let Some(picture) = RgbaImage::from_raw(texture.width(), texture.height(), bytes) {
        picture.write_to(&mut png, ImageFormat::Png)?;
    }
    Ok(png.into_inner())
}

fn material(material: &Material) -> Value {
    let color = material.base_color.extend(material.alpha);
    let mut pbr = json!({
        "baseColorFactor": color.to_array(),
        "metallicFactor": material.metallic,
        "roughnessFactor": material.roughness,
    });
    if let Some(reference) = &material.base_color_texture {
        pbr["baseColorTexture"] = texture_info(reference);
    }
    if let Some(reference) = &material.metallic_roughness_texture {
        pbr["metallicRoughnessTexture"] = texture_info(reference);
    }
    let mut json = json!({
        "name": material.name,
        "pbrMetallicRoughness": pbr,
        "doubleSided": material.double_sided,
        "extensions": {"KHR_materials_specular": {"specularFactor": material.specular}},
    });
    if let AlphaMode::Mask { cutoff } = material.alpha_mode {
        json["alphaMode"] = json!("MASK");
        json["alphaCutoff"] = json!(cutoff);
    }
    if material.is_emissive() {
        // The factor has to stay within 0 to 1.
        let strength = material.emission.max_element().max(1.0);
        json["emissiveFactor"] = json!((material.emission / strength).to_array());
        json["extensions"]["KHR_materials_emissive_strength"] =
            json!({"emissiveStrength": strength});
    }
    json
}

/// A texture with its transform, as translation · rotation · scale. A shear, which the
/// standard cannot state, does not come from any file either.
fn texture_info(reference: &TextureRef) -> Value {
    let mut info = json!({"index": reference.texture});
    let matrix = reference.texture_from_uv.matrix2;
    if reference.texture_from_uv != glam::Affine2::IDENTITY {
        let mirrored = if matrix.determinant() < 0.0 {
            -1.0
        } else {
            1.0
        };
        info["extensions"] = json!({"KHR_texture_transform": {
            "offset": reference.texture_from_uv.translation.to_array(),
            "rotation": -matrix.x_axis.y.atan2(matrix.x_axis.x),
            "scale": [matrix.x_axis.length(), mirrored * matrix.y_axis.length()],
        }});
    }
    info
}

/// The document as it grows.
pub(super) struct Document {
    materials: Materials,
    nodes: Vec<Value>,
    meshes: Vec<Value>,
    cameras: Vec<Value>,
    lights: Vec<Value>,
}

impl Document {
    pub(super) fn new(materials: Materials) -> Self {
        Self {
            materials,
            nodes: Vec::new(),
            meshes: Vec::new(),
            cameras: Vec::new(),
            lights: Vec::new(),
        }
    }

    pub(super) fn add_material(&mut self, material: Value) -> usize {
        self.materials.materials.push(material);
        self.materials.materials.len() - 1
    }

    pub(super) fn add_mesh(&mut self, name: &str, primitive: Value) {
        self.nodes
            .push(json!({"name": name, "mesh": self.meshes.len()}));
        self.meshes
            .push(json!({"name": name, "primitives": [primitive]}));
    }

    pub(super) fn add_light(&mut self, light: Value, mut node: Value) {
        node["extensions"] = json!({"KHR_lights_punctual": {"light": self.lights.len()}});
        self.nodes.push(node);
        self.lights.push(light);
    }

    pub(super) fn add_camera(&mut self, camera: Value, mut node: Value) {
        node["camera"] = json!(self.cameras.len());
        self.nodes.push(node);
        self.cameras.push(camera);
    }

    /// The whole, without empty lists, which the standard forbids.
    pub(super) fn into_json(self) -> Value {
        let textures: Vec<Value> = (0..self.materials.images.len())
            .map(|index| json!({"source": index, "sampler": 0}))
            .collect();
        let mut document = json!({
            "asset": {"version": "2.0", "generator": "lie"},
            "scene": 0,
        });
        document["scenes"] = if self.nodes.is_empty() {
            json!([{}])
        } else {
            json!([{"nodes": (0..self.nodes.len()).collect::<Vec<_>>()}])
        };
        let mut used = vec![
            "KHR_materials_specular",
            "KHR_materials_emissive_strength",
            "KHR_texture_transform",
        ];
        if !textures.is_empty() {
            document["samplers"] = json!([{"wrapS": 10497, "wrapT": 10497}]);
        }
        if !self.lights.is_empty() {
            document["extensions"] = json!({"KHR_lights_punctual": {"lights": self.lights}});
            used.push("KHR_lights_punctual");
        }
        document["extensionsUsed"] = json!(used);
        for (key, list) in [
            ("nodes", self.nodes),
            ("meshes", self.meshes),
            ("cameras", self.cameras),
            ("materials", self.materials.materials),
            ("textures", textures),
            ("images", self.materials.images),
        ] {
            if !list.is_empty() {
                document[key] = Value::Array(list);
            }
        }
        document
    }
}
