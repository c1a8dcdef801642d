use glam::Vec3;

use super::mesh::Mesh;
use crate::{Camera, Material, draft::Draft};

/// The box in metres, after the data of the Cornell box at ten times its scale in
/// decimetres: 5.5 wide, 5.5 high and 5.6 deep, open towards +z.
pub(crate) fn draft() -> Draft {
    let mut draft = Draft::default();
    let white = draft.add_material(Material::diffuse("white", Vec3::new(0.73, 0.72, 0.68)));
    let red = draft.add_material(Material::diffuse("red", Vec3::new(0.57, 0.04, 0.04)));
    let green = draft.add_material(Material::diffuse("green", Vec3::new(0.12, 0.45, 0.09)));
    let lamp = draft.add_material(Material {
        emission: Vec3::new(17.0, 12.0, 4.0),
        ..Material::diffuse("lamp", Vec3::splat(0.78))
    });
    let (width, height, depth) = (5.5 * Vec3::X, 5.5 * Vec3::Y, 5.6 * Vec3::Z);
    let corner = Vec3::new(-2.75, 0.0, -5.6);
    for (name, material, at, edge_u, edge_v) in [
        ("floor", white, corner, depth, width),
        ("ceiling", white, corner + height, width, depth),
        ("back wall", white, corner, width, height),
        ("left wall", red, corner, height, depth),
        ("right wall", green, corner + width, depth, height),
        // A little below the ceiling, facing down.
        (
            "lamp",
            lamp,
            Vec3::new(-0.65, 5.49, -3.3),
            1.3 * Vec3::X,
            1.05 * Vec3::Z,
        ),
    ] {
        let mut mesh = Mesh::default();
        mesh.quad(at, edge_u, edge_v);
        mesh.into_part(&mut draft, name, material);
    }
    for (name, center, angle, side, tall) in [
        (
            "short block",
            Vec3::new(0.95, 0.0, -1.7),
            -0.29f32,
            1.65,
            1.65,
        ),
        ("tall block", Vec3::new(-0.93, 0.0, -3.5), 0.31, 1.65, 3.3),
    ] {
        let x = side * Vec3::new(angle.cos(), 0.0, -angle.sin());
        let z = side * Vec3::new(angle.sin(), 0.0, angle.cos());
        let mut mesh = Mesh::default();
        mesh.block(center - 0.5 * (x + z), x, tall * Vec3::Y, z);
        mesh.into_part(&mut draft, name, white);
    }
    let (eye, target) = (Vec3::new(0.0, 2.75, 8.0), Vec3::new(0.0, 2.75, -2.8));
    draft
        .cameras
        .push(Camera::look_at("front", eye, target, Vec3::Y, 0.68));
    draft
}

#[cfg(test)]
mod tests {
    use crate::{AreaShape, LightKind};

    #[test]
    fn its_lamp_is_one_rectangle_that_shines_down() {
        let scene = super::super::cornell_box();
        scene.validate().unwrap();
        assert_eq!(scene.geometry.len(), 36);
        let [light] = &scene.lights[..] else {
            panic!("one light");
        };
        let LightKind::Area(area) = &light.kind else {
            panic!("an area light");
        };
        assert!(matches!(area.shape(), AreaShape::Rectangle { .. }));
        assert!(area.triangles()[0].normal.y < -0.999);
        assert!((area.area() - 1.365).abs() < 1.0e-3);
    }
}
