use lie_protocol::{codec, limit};
use lie_scene::{
    AlphaMode, AreaLight, AreaShape, Light, LightKind, Material, Scene, Texture, TextureRef,
};

use super::{
    BlobError, MAGIC, VERSION,
    arrays::put_floats,
    description::{
        Description, KindDescription, LightDescription, MaterialDescription, Part,
        TextureDescription, TextureUse,
    },
};
use crate::convert;

/// A scene as a container.
///
/// # Errors
/// [`BlobError::TooLong`] if no peer would take it.
pub fn encode(scene: &Scene) -> Result<Vec<u8>, BlobError> {
    let mut description = Vec::new();
    codec::write(&describe(scene), &mut description).map_err(BlobError::Description)?;

    let geometry = &scene.geometry;
    let mut out = Vec::with_capacity(
        64 + description.len() + 32 * geometry.vertices().len() + 12 * geometry.len(),
    );
    out.extend_from_slice(&MAGIC);
    out.extend_from_slice(&VERSION.to_le_bytes());
    out.extend_from_slice(&(description.len() as u64).to_le_bytes());
    out.extend_from_slice(&description);
    for vertex in geometry.vertices() {
        put_floats(&mut out, vertex.position.to_array());
        put_floats(&mut out, vertex.normal.to_array());
        put_floats(&mut out, vertex.uv.to_array());
    }
    for index in geometry.triangles().iter().flatten() {
        out.extend_from_slice(&index.to_le_bytes());
    }
    for light in &scene.lights {
        for corner in mesh_of(light).iter().flatten() {
            put_floats(&mut out, corner.to_array());
        }
    }
    for texture in &scene.textures {
        out.extend_from_slice(texture.texels().as_flattened());
    }
    if out.len() as u64 > limit::SCENE {
        return Err(BlobError::TooLong(out.len()));
    }
    Ok(out)
}

fn describe(scene: &Scene) -> Description {
    Description {
        name: scene.name.clone(),
        vertices: scene.geometry.vertices().len() as u64,
        triangles: scene.geometry.len() as u64,
        parts: scene.geometry.parts().iter().map(part).collect(),
        materials: scene.materials.iter().map(material).collect(),
        textures: scene.textures.iter().map(texture).collect(),
        lights: scene.lights.iter().map(light).collect(),
        cameras: scene.cameras.iter().map(convert::wire_camera).collect(),
        walkthroughs: scene
            .walkthroughs
            .iter()
            .map(convert::wire_walkthrough)
            .collect(),
        background: scene.background.radiance.to_array(),
        settings: convert::wire_settings(&scene.settings),
    }
}

fn part(part: &lie_scene::MeshPart) -> Part {
    Part {
        name: part.name.clone(),
        start: part.triangles.start,
        end: part.triangles.end,
        material: part.material,
    }
}

fn material(material: &Material) -> MaterialDescription {
    MaterialDescription {
        name: material.name.clone(),
        base_color: material.base_color.to_array(),
        base_color_texture: material.base_color_texture.map(texture_use),
        alpha: material.alpha,
        metallic: material.metallic,
        roughness: material.roughness,
        metallic_roughness_texture: material.metallic_roughness_texture.map(texture_use),
        specular: material.specular,
        emission: material.emission.to_array(),
        double_sided: material.double_sided,
        mask_cutoff: match material.alpha_mode {
            AlphaMode::Opaque => None,
            AlphaMode::Mask { cutoff } => Some(cutoff),
        },
    }
}

fn texture_use(reference: TextureRef) -> TextureUse {
    TextureUse {
        texture: reference.texture,
        texture_from_uv: reference.texture_from_uv.to_cols_array(),
    }
}

fn texture(texture: &Texture) -> TextureDescription {
    TextureDescription {
        width: texture.width(),
        height: texture.height(),
        srgb: texture.is_srgb(),
    }
}

fn light(light: &Light) -> LightDescription {
    let kind = match &light.kind {
        LightKind::Point {
            position,
            radiant_intensity,
        } => KindDescription::Point {
            position: position.to_array(),
            radiant_intensity: radiant_intensity.to_array(),
        },
        LightKind::Spot {
            position,
            direction,
            radiant_intensity,
            cos_inner,
            cos_outer,
        } => KindDescription::Spot {
            position: position.to_array(),
            direction: direction.to_array(),
            radiant_intensity: radiant_intensity.to_array(),
            cosines: [*cos_inner, *cos_outer],
        },
        LightKind::Directional {
            direction,
            irradiance,
        } => KindDescription::Directional {
            direction: direction.to_array(),
            irradiance: irradiance.to_array(),
        },
        LightKind::Area(area) => area_light(area),
    };
    LightDescription {
        name: light.name.clone(),
        kind,
    }
}

fn area_light(area: &AreaLight) -> KindDescription {
    let (radiance, double_sided) = (area.radiance.to_array(), area.double_sided);
    match area.shape() {
        AreaShape::Rectangle {
            corner,
            edge_u,
            edge_v,
        } => KindDescription::Rectangle {
            corner: corner.to_array(),
            edge_u: edge_u.to_array(),
            edge_v: edge_v.to_array(),
            radiance,
            double_sided,
        },
        AreaShape::Mesh { triangles } => KindDescription::Mesh {
            triangles: triangles.len() as u64,
            radiance,
            double_sided,
        },
    }
}

fn mesh_of(light: &Light) -> &[[glam::Vec3; 3]] {
    match &light.kind {
        LightKind::Area(area) => match area.shape() {
            AreaShape::Mesh { triangles } => triangles,
            AreaShape::Rectangle { .. } => &[],
        },
        _ => &[],
    }
}
