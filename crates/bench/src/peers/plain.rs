use glam::Vec3;
use lie_scene::{
    AlphaMode, AreaShape, Geometry, GeometryError, Light, LightKind, Material, MeshPart, Scene,
    Vertex,
};

/// A scene with nothing in it that [`super::write_flat`] cannot say.
#[derive(Clone, Debug, PartialEq)]
pub struct PlainScene {
    /// The scene.
    pub scene: Scene,
    /// Lights that had to be left out, each with what it is.
    pub left_out: Vec<String>,
}

/// The same scene in plain: matt, opaque surfaces of one colour each, shaded flat, under points,
/// spots whose cones have hard edges (at the outer angle), and parallelograms.
///
/// Colours are those of the materials, without their textures. What shines is taken out of the
/// geometry: its light is a light, which neither blocks rays nor is seen. One camera ray goes
/// through each pixel, and area lights get a square number of sample points, at most as many as
/// before.
///
/// # Errors
/// Never for the geometry of a valid scene.
pub fn plain(scene: &Scene) -> Result<PlainScene, GeometryError> {
    let mut left_out = vec![];
    let lights = scene.lights.iter().filter_map(|light| {
        let plain = plain_light(light);
        if let Err(kind) = &plain {
            left_out.push(format!("'{}' ({kind})", light.name));
        }
        plain.ok()
    });
    let lights = lights.collect();
    let mut settings = scene.settings;
    settings.samples_per_pixel = 1;
    settings.light_samples = settings.light_samples.isqrt().pow(2);
    let scene = Scene {
        geometry: plain_geometry(scene)?,
        materials: scene.materials.iter().map(plain_material).collect(),
        textures: vec![],
        lights,
        background: lie_scene::Background::default(),
        settings,
        ..scene.clone()
    };
    Ok(PlainScene { scene, left_out })
}

/// All triangles that do not shine, without normals.
fn plain_geometry(scene: &Scene) -> Result<Geometry, GeometryError> {
    let geometry = &scene.geometry;
    let flat = |vertex: &Vertex| Vertex {
        normal: Vec3::ZERO,
        ..*vertex
    };
    let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(geometry.len());
    let mut parts = vec![];
    for part in geometry.parts() {
        if scene.materials[part.material as usize].is_emissive() {
            continue;
        }
        let first = triangles.len() as u32;
        let own = part.triangles.start as usize..part.triangles.end as usize;
        triangles.extend(&geometry.triangles()[own]);
        parts.push(MeshPart {
            triangles: first..triangles.len() as u32,
            ..part.clone()
        });
    }
    Geometry::new(
        geometry.vertices().iter().map(flat).collect(),
        triangles,
        parts,
    )
}

fn plain_material(material: &Material) -> Material {
    Material {
        base_color_texture: None,
        metallic_roughness_texture: None,
        alpha: 1.0,
        alpha_mode: AlphaMode::Opaque,
        metallic: 0.0,
        specular: 0.0,
        emission: Vec3::ZERO,
        ..material.clone()
    }
}

/// The light, or what it is that cannot be written.
fn plain_light(light: &Light) -> Result<Light, &'static str> {
    let mut plain = light.clone();
    match &mut plain.kind {
        LightKind::Point { .. } => {}
        LightKind::Spot {
            cos_inner,
            cos_outer,
            ..
        } => *cos_inner = *cos_outer,
        LightKind::Directional { .. } => return Err("a directional light"),
        LightKind::Area(area) => {
            if matches!(area.shape(), AreaShape::Mesh { .. }) {
                return Err("an area light that is no parallelogram");
            }
        }
    }
    Ok(plain)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lie_scene::AreaLight;

    #[test]
    fn a_plain_scene_is_matt_flat_and_does_not_show_its_lamps() {
        let mut scene = lie_scene::bar(&lie_scene::Bar {
            detail: 0.2,
            ..lie_scene::Bar::default()
        });
        scene.settings.light_samples = 20;
        let spots = scene.lights.len();
        let lamp = lie_scene::cornell_box().lights.remove(0);
        scene.lights.push(lamp);
        scene.materials[0].emission = Vec3::ONE;
        let shining: usize = scene
            .geometry
            .parts()
            .iter()
            .filter(|part| part.material == 0)
            .map(|part| part.triangles.len())
            .sum();
        assert!(shining > 0, "the first material is used");
        let plain = plain(&scene).unwrap();
        assert_eq!(plain.left_out, Vec::<String>::new());
        let made = &plain.scene;
        made.validate().unwrap();
        assert_eq!(made.geometry.len() + shining, scene.geometry.len());
        let flat = made.geometry.vertices().iter();
        assert!(flat.into_iter().all(|vertex| vertex.normal == Vec3::ZERO));
        for material in &made.materials {
            assert_eq!((material.specular, material.metallic), (0.0, 0.0));
            assert!(material.base_color_texture.is_none() && !material.is_emissive());
        }
        assert_eq!(made.lights.len(), spots + 1);
        assert_eq!(made.settings.light_samples, 16);
        for light in &made.lights {
            if let LightKind::Spot {
                cos_inner,
                cos_outer,
                ..
            } = light.kind
            {
                assert_eq!(cos_inner, cos_outer);
            }
        }
    }

    #[test]
    fn lights_that_cannot_be_written_are_named() {
        let mut scene = lie_scene::cornell_box();
        let light = |name: &str, kind| Light {
            name: name.to_owned(),
            kind,
        };
        let sun = LightKind::Directional {
            direction: Vec3::NEG_Y,
            irradiance: Vec3::ONE,
        };
        let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]];
        let mesh = AreaLight::new(AreaShape::Mesh { triangles }, Vec3::ONE, false);
        scene.lights.push(light("sun", sun));
        scene.lights.push(light("shard", LightKind::Area(mesh)));
        let plain = plain(&scene).unwrap();
        assert_eq!(plain.scene.lights.len(), 1);
        assert_eq!(
            plain.left_out,
            [
                "'sun' (a directional light)",
                "'shard' (an area light that is no parallelogram)"
            ]
        );
    }
}
