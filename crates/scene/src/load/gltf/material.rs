//! Materials and the textures they use.

use std::{collections::HashMap, path::Path};

use glam::{Affine2, Vec2, Vec3, Vec4Swizzles};
use gltf::{mesh::Primitive, texture::Info};

use super::Document;
use crate::{
    AlphaMode, Material, Texture, TextureRef,
    draft::Draft,
    load::{LoadError, MAX_TEXTURE_BYTES, picture, source},
};

/// Textures made so far, by image and by whether they are sRGB; `None` if it failed.
type Cache = HashMap<(usize, bool), Option<u32>>;

impl Document<'_> {
    /// Adds every material of the file, in its order.
    pub(super) fn add_materials(&self, draft: &mut Draft) -> Result<(), LoadError> {
        self.check_lights()?;
        let mut cache = Cache::new();
        for material in self.gltf.materials() {
            let converted = self.material(&material, &mut cache, draft)?;
            draft.materials.push(converted);
        }
        Ok(())
    }

    /// The scene's index of a primitive's material. Those without share a grey one.
    pub(super) fn material_index(&self, primitive: &Primitive<'_>, draft: &mut Draft) -> u32 {
        if let Some(index) = primitive.material().index() {
            return index as u32;
        }
        let own = self.gltf.materials().len();
        if draft.materials.len() == own {
            draft.materials.push(Material::default());
        }
        own as u32
    }

    /// Which set of texture coordinates a primitive needs.
    pub(super) fn texture_set(&self, primitive: &Primitive<'_>) -> u32 {
        let pbr = primitive.material().pbr_metallic_roughness();
        pbr.base_color_texture()
            .or(pbr.metallic_roughness_texture())
            .map_or(0, |info| texture_set(&info))
    }

    fn material(
        &self,
        material: &gltf::Material<'_>,
        cache: &mut Cache,
        draft: &mut Draft,
    ) -> Result<Material, LoadError> {
        let index = material.index().unwrap_or_default();
        let name = material
            .name()
            .map_or_else(|| format!("material {index}"), str::to_owned);
        let element = format!("material {index} '{}'", source::shorten(&name));
        let pbr = material.pbr_metallic_roughness();
        let factor = glam::Vec4::from(pbr.base_color_factor());
        let strength = material.emissive_strength().unwrap_or(1.0);
        let specular = material
            .specular()
            .map_or(1.0, |specular| specular.specular_factor());
        let numbers = [
            pbr.metallic_factor(),
            pbr.roughness_factor(),
            specular,
            strength,
        ];
        let mut emission = Vec3::from(material.emissive_factor()) * strength;
        if !(factor.is_finite() && emission.is_finite() && numbers.iter().all(|n| n.is_finite())) {
            return Err(self.file.error(element, "expected finite factors"));
        }
        let unit = |value: f32| (0.0..=1.0).contains(&value);
        if !(factor
            .to_array()
            .into_iter()
            .chain(numbers[..3].iter().copied())
            .all(unit)
            && emission.min_element() >= 0.0)
        {
            draft
                .warnings
                .push(format!("{element}: factors outside 0 to 1 are clamped"));
        }
        if material.ior().is_some_and(|ior| (ior - 1.5).abs() > 1.0e-3) {
            draft
                .warnings
                .push("KHR_materials_ior is ignored: dielectrics have 1.5".into());
        }
        for (found, what) in [
            (
                material.normal_texture().is_some(),
                "normal textures are ignored",
            ),
            (
                material.occlusion_texture().is_some(),
                "occlusion textures are ignored",
            ),
        ] {
            if found {
                draft.warnings.push(what.into());
            }
        }
        if let Some(info) = material.emissive_texture()
            && emission != Vec3::ZERO
            && let Some(texture) = self.decode(&info.texture(), true, draft)?
        {
            emission *= texture.mean().xyz();
            draft.warnings.push(format!(
                "{element}: the emissive texture counts as its mean colour"
            ));
        }
        let alpha_mode = match material.alpha_mode() {
            gltf::material::AlphaMode::Opaque => AlphaMode::Opaque,
            gltf::material::AlphaMode::Mask => AlphaMode::Mask {
                cutoff: material.alpha_cutoff().unwrap_or(0.5),
            },
            gltf::material::AlphaMode::Blend => {
                draft.warnings.push(format!(
                    "{element}: blending is replaced by a mask at alpha 0.5"
                ));
                AlphaMode::Mask { cutoff: 0.5 }
            }
        };
        Ok(Material {
            name,
            base_color: factor.xyz().clamp(Vec3::ZERO, Vec3::ONE),
            base_color_texture: self.texture(pbr.base_color_texture(), true, cache, draft)?,
            alpha: factor.w.clamp(0.0, 1.0),
            metallic: pbr.metallic_factor().clamp(0.0, 1.0),
            roughness: pbr.roughness_factor().clamp(0.0, 1.0),
            metallic_roughness_texture: self.texture(
                pbr.metallic_roughness_texture(),
                false,
                cache,
                draft,
            )?,
            specular: specular.clamp(0.0, 1.0),
            emission: emission.max(Vec3::ZERO),
            double_sided: material.double_sided(),
            alpha_mode,
        })
    }

    fn texture(
        &self,
        info: Option<Info<'_>>,
        srgb: bool,
        cache: &mut Cache,
        draft: &mut Draft,
    ) -> Result<Option<TextureRef>, LoadError> {
        let Some(info) = info else {
            return Ok(None);
        };
        let key = (info.texture().source().index(), srgb);
        let index = match cache.get(&key) {
            Some(&known) => known,
            None => {
                let made = self.decode(&info.texture(), srgb, draft)?.map(|texture| {
                    draft.textures.push(texture);
                    draft.textures.len() as u32 - 1
                });
                cache.insert(key, made);
                made
            }
        };
        let texture_from_uv = info
            .texture_transform()
            .map_or(Affine2::IDENTITY, |transform| {
                // KHR_texture_transform turns counter-clockwise with v pointing down.
                let scale = Affine2::from_scale(Vec2::from(transform.scale()));
                let turn = Affine2::from_angle(-transform.rotation());
                Affine2::from_translation(Vec2::from(transform.offset())) * turn * scale
            });
        Ok(index.map(|texture| TextureRef {
            texture,
            texture_from_uv,
        }))
    }

    /// Decodes a texture's image. One that is missing or broken is a warning and no texture.
    fn decode(
        &self,
        texture: &gltf::Texture<'_>,
        srgb: bool,
        draft: &mut Draft,
    ) -> Result<Option<Texture>, LoadError> {
        let index = texture.source().index();
        let wrap = texture.sampler();
        let repeat = gltf::texture::WrappingMode::Repeat;
        if wrap.wrap_s() != repeat || wrap.wrap_t() != repeat {
            draft
                .warnings
                .push("textures always repeat, whatever their sampler says".into());
        }
        let image = &self.gltf.as_json().images[index];
        let folder = self.file.path.parent().unwrap_or(Path::new(""));
        let decoded = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => match source::resolve(uri, folder) {
                Ok(source::Target::Data(bytes)) => picture::decode(&bytes, srgb),
                Ok(source::Target::File(path)) => source::read(&path)
                    .map_err(|error| error.to_string())
                    .and_then(|bytes| picture::decode(&bytes, srgb)),
                Err(problem) => Err(problem),
            },
            (None, Some(view)) => match self.gltf.views().nth(view.value()) {
                Some(view) => picture::decode(self.view(&view)?, srgb),
                None => Err("its buffer view does not exist".into()),
            },
            (None, None) => Err("it has neither a URI nor a buffer view".into()),
        };
        match decoded {
            Ok(texture) => {
                let held: usize = draft
                    .textures
                    .iter()
                    .map(|texture| texture.texels().len() * 4)
                    .sum();
                if held + texture.texels().len() * 4 > MAX_TEXTURE_BYTES {
                    let problem = format!("all textures together exceed {MAX_TEXTURE_BYTES} bytes");
                    return Err(self.file.error(format!("image {index}"), problem));
                }
                Ok(Some(texture))
            }
            Err(problem) => {
                draft.warnings.push(format!(
                    "image {index}: {problem}; the factor alone is used"
                ));
                Ok(None)
            }
        }
    }
}

fn texture_set(info: &Info<'_>) -> u32 {
    info.texture_transform()
        .and_then(|transform| transform.tex_coord())
        .unwrap_or_else(|| info.tex_coord())
}
