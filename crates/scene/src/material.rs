use glam::{Affine2, Vec2, Vec3};

/// How a surface reflects and emits: glTF's metallic-roughness model.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name from the file, for people.
    pub name: String,
    /// Diffuse albedo of a dielectric, specular colour of a metal; each channel in `[0, 1]`.
    pub base_color: Vec3,
    /// Multiplies `base_color`; its alpha drives [`AlphaMode::Mask`].
    pub base_color_texture: Option<TextureRef>,
    /// Alpha where no texture says otherwise, in `[0, 1]`.
    pub alpha: f32,
    /// 0 is a dielectric, 1 a metal.
    pub metallic: f32,
    /// Perceptual roughness in `[0, 1]`; GGX α is its square.
    pub roughness: f32,
    /// Roughness in green, metalness in blue, each multiplying its factor.
    pub metallic_roughness_texture: Option<TextureRef>,
    /// Strength of a dielectric's specular lobe (`KHR_materials_specular`): 1 is 4 % at
    /// normal incidence, 0 is a pure Lambertian surface.
    pub specular: f32,
    /// Emitted radiance, in W·sr⁻¹·m⁻², from the front (both sides if `double_sided`).
    pub emission: Vec3,
    /// Whether emission leaves both sides. Reflection is always two-sided.
    pub double_sided: bool,
    /// Whether alpha cuts holes.
    pub alpha_mode: AlphaMode,
}

/// What alpha means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    Opaque,
    /// Where alpha is below the cutoff there is no surface, for eye and shadow alike.
    Mask {
        /// Smallest alpha that still is a surface.
        cutoff: f32,
    },
}

/// A texture as one material uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureRef {
    /// Index into the scene's textures.
    pub texture: u32,
    /// Texture space from vertex coordinates (`KHR_texture_transform`).
    pub texture_from_uv: Affine2,
}

impl TextureRef {
    /// A texture used as it is.
    #[must_use]
    pub fn plain(texture: u32) -> Self {
        Self {
            texture,
            texture_from_uv: Affine2::IDENTITY,
        }
    }

    /// Texture coordinates for a vertex's.
    #[must_use]
    pub fn map(&self, uv: Vec2) -> Vec2 {
        self.texture_from_uv.transform_point2(uv)
    }
}

impl Default for Material {
    /// A grey Lambertian surface.
    fn default() -> Self {
        Self {
            name: "default".into(),
            base_color: Vec3::splat(0.5),
            base_color_texture: None,
            alpha: 1.0,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            specular: 0.0,
            emission: Vec3::ZERO,
            double_sided: false,
            alpha_mode: AlphaMode::Opaque,
        }
    }
}

impl Material {
    /// A Lambertian surface.
    #[must_use]
    pub fn diffuse(name: impl Into<String>, albedo: Vec3) -> Self {
        Self {
            name: name.into(),
            base_color: albedo,
            ..Self::default()
        }
    }

    /// Whether it may cut holes: such triangles need a look at the texture at every hit.
    #[must_use]
    pub fn is_masked(&self) -> bool {
        matches!(self.alpha_mode, AlphaMode::Mask { .. })
    }

    /// Whether it gives off light.
    #[must_use]
    pub fn is_emissive(&self) -> bool {
        self.emission.max_element() > 0.0
    }
}
