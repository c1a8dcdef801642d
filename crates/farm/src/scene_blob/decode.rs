use glam::{Affine2, Vec2, Vec3};
use lie_protocol::codec;
use lie_scene::{
    AlphaMode, AreaLight, AreaShape, Background, Geometry, Light, LightKind, Material, MeshPart,
    Scene, Texture, TextureRef, Vertex,
};

use super::{
    BlobError, MAGIC, VERSION,
    arrays::Arrays,
    description::{
        CLAIM, Description, KindDescription, LightDescription, MaterialDescription, Part,
        TextureDescription, TextureUse,
    },
};
use crate::convert;

/// Reads a container. The scene is valid when it comes out.
///
/// # Errors
/// [`BlobError`] says what is wrong; counts are checked against the bytes that are there
/// before anything of their size is allocated.
pub fn decode(bytes: &[u8]) -> Result<Scene, BlobError> {
    let (description, arrays) = split(bytes).ok_or(BlobError::Container)?;
    let description = match codec::read_within::<Description, CLAIM>(description) {
        Ok((description, [])) => description,
        Ok(_) => return Err(BlobError::Description("bytes follow its end".to_owned())),
        Err(reason) => return Err(BlobError::Description(reason)),
    };
    let mut arrays = Arrays { rest: arrays };
    let scene = assemble(description, &mut arrays)?;
    if !arrays.rest.is_empty() {
        return Err(BlobError::Array {
            array: "last bytes",
        });
    }
    scene.validate()?;
    Ok(scene)
}

/// The description's bytes and what follows them.
fn split(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (magic, bytes) = bytes.split_first_chunk::<8>()?;
    let (version, bytes) = bytes.split_first_chunk::<4>()?;
    let (length, bytes) = bytes.split_first_chunk::<8>()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    if *magic != MAGIC || u32::from_le_bytes(*version) != VERSION {
        return None;
    }
    bytes.split_at_checked(length)
}

fn assemble(description: Description, arrays: &mut Arrays<'_>) -> Result<Scene, BlobError> {
    let vertices = arrays.floats::<8>(description.vertices, "vertices")?;
    let vertices = vertices.map(vertex).collect();
    let triangles = arrays.words::<3>(description.triangles, "triangles")?;
    let triangles = triangles
        .map(|words| words.map(u32::from_le_bytes))
        .collect();
    let parts = description.parts.into_iter().map(part).collect();
    let lights = description.lights.into_iter();
    let lights = lights.map(|light| self::light(light, arrays));
    let lights = lights.collect::<Result<_, _>>()?;
    let textures = description.textures.iter();
    let textures = textures.map(|texture| self::texture(texture, arrays));
    Ok(Scene {
        name: description.name,
        geometry: Geometry::new(vertices, triangles, parts)?,
        materials: description.materials.into_iter().map(material).collect(),
        textures: textures.collect::<Result<_, _>>()?,
        lights,
        cameras: description
            .cameras
            .iter()
            .map(convert::unchecked_camera)
            .collect(),
        walkthroughs: description
            .walkthroughs
            .iter()
            .map(convert::unchecked_walkthrough)
            .collect(),
        background: Background {
            radiance: Vec3::from(description.background),
        },
        settings: convert::settings(&description.settings),
    })
}

fn vertex([x, y, z, nx, ny, nz, u, v]: [f32; 8]) -> Vertex {
    Vertex {
        position: Vec3::new(x, y, z),
        normal: Vec3::new(nx, ny, nz),
        uv: Vec2::new(u, v),
    }
}

fn part(part: Part) -> MeshPart {
    MeshPart {
        name: part.name,
        triangles: part.start..part.end,
        material: part.material,
    }
}

fn material(material: MaterialDescription) -> Material {
    Material {
        name: material.name,
        base_color: Vec3::from(material.base_color),
        base_color_texture: material.base_color_texture.map(texture_ref),
        alpha: material.alpha,
        metallic: material.metallic,
        roughness: material.roughness,
        metallic_roughness_texture: material.metallic_roughness_texture.map(texture_ref),
        specular: material.specular,
        emission: Vec3::from(material.emission),
        double_sided: material.double_sided,
        alpha_mode: material
            .mask_cutoff
            .map_or(AlphaMode::Opaque, |cutoff| AlphaMode::Mask { cutoff }),
    }
}

fn texture_ref(reference: TextureUse) -> TextureRef {
    TextureRef {
        texture: reference.texture,
        texture_from_uv: Affine2::from_cols_array(&reference.texture_from_uv),
    }
}

fn texture(texture: &TextureDescription, arrays: &mut Arrays<'_>) -> Result<Texture, BlobError> {
    let count = u64::from(texture.width) * u64::from(texture.height);
    let texels = arrays.words::<1>(count, "texels")?.map(|[texel]| texel);
    let texels = texels.collect();
    Ok(Texture::new(
        texture.width,
        texture.height,
        texture.srgb,
        texels,
    )?)
}

fn light(light: LightDescription, arrays: &mut Arrays<'_>) -> Result<Light, BlobError> {
    let kind = match light.kind {
        KindDescription::Point {
            position,
            radiant_intensity,
        } => LightKind::Point {
            position: position.into(),
            radiant_intensity: radiant_intensity.into(),
        },
        KindDescription::Spot {
            position,
            direction,
            radiant_intensity,
            cosines: [cos_inner, cos_outer],
        } => LightKind::Spot {
            position: position.into(),
            direction: direction.into(),
            radiant_intensity: radiant_intensity.into(),
            cos_inner,
            cos_outer,
        },
        KindDescription::Directional {
            direction,
            irradiance,
        } => LightKind::Directional {
            direction: direction.into(),
            irradiance: irradiance.into(),
        },
        KindDescription::Rectangle {
            corner,
            edge_u,
            edge_v,
            radiance,
            double_sided,
        } => {
            let shape = AreaShape::Rectangle {
                corner: corner.into(),
                edge_u: edge_u.into(),
                edge_v: edge_v.into(),
            };
            LightKind::Area(AreaLight::new(shape, radiance.into(), double_sided))
        }
        KindDescription::Mesh {
            triangles,
            radiance,
            double_sided,
        } => {
            let corners = arrays.floats::<9>(triangles, "light triangles")?;
            let triangles = corners
                .map(|c| [0, 3, 6].map(|at| Vec3::new(c[at], c[at + 1], c[at + 2])))
                .collect();
            let shape = AreaShape::Mesh { triangles };
            LightKind::Area(AreaLight::new(shape, radiance.into(), double_sided))
        }
    };
    Ok(Light {
        name: light.name,
        kind,
    })
}
