use std::io::{self, Write};

use glam::{UVec2, Vec3};
use lie_scene::{AreaLight, AreaShape, Camera, Light, LightKind, Scene};

use super::PeerError;

/// Both sides of a picture are multiples of this, in pixels.
pub const SIDE_STEP: u32 = 16;

/// Writes a view of a [`plain`](super::plain) scene in the flat format that other programs read.
///
/// Little-endian, without padding: `LIEB`; six `i32`: vertices, triangles, materials, lights, width
/// and height; thirteen `f32` of the camera: position, forward, right (longer than 1 where the
/// picture is wider than high), up, and the tangent of half the vertical field of view; for each
/// vertex its position in metres; for each triangle its three vertices as `u32`; for each
/// triangle its material as `i32`; for each material its albedo; for each light seventeen `f32`.
/// These are: 0 for a point, 1 for a spot, 2 for a parallelogram; position or corner; the way a
/// spot shines; radiant intensity or radiance, as in a [`Scene`]; cosine of a spot's outer
/// angle; the parallelogram's edges u and v, to the side of whose u × v it shines.
///
/// # Errors
/// [`PeerError::Scene`] if the format has no words for something; [`PeerError::File`] with what
/// `to` says.
pub fn write_flat(
    to: &mut dyn Write,
    scene: &Scene,
    camera: &Camera,
    size: UVec2,
) -> Result<(), PeerError> {
    if size % SIDE_STEP != UVec2::ZERO {
        let problem = format!("a picture of {size} has a side that is no multiple of {SIDE_STEP}");
        return Err(PeerError::Scene(problem));
    }
    let mut lights: Vec<FlatLight> = vec![];
    for light in &scene.lights {
        push_light(&mut lights, light)?;
    }
    let geometry = &scene.geometry;
    let counts = [
        geometry.vertices().len(),
        geometry.len(),
        scene.materials.len(),
        lights.len(),
        size.x as usize,
        size.y as usize,
    ];
    to.write_all(b"LIEB")?;
    for count in counts {
        let count = i32::try_from(count)
            .map_err(|_| PeerError::Scene(format!("{count} is more than 31 bits hold")))?;
        to.write_all(&count.to_le_bytes())?;
    }
    write_camera(to, camera, size)?;
    for vertex in geometry.vertices() {
        write_vector(to, vertex.position)?;
    }
    for corner in geometry.triangles().iter().flatten() {
        to.write_all(&corner.to_le_bytes())?;
    }
    for triangle in 0..geometry.len() as u32 {
        to.write_all(&geometry.material_of(triangle).to_le_bytes())?;
    }
    for material in &scene.materials {
        write_vector(to, material.base_color)?;
    }
    for value in lights.iter().flatten() {
        to.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

type FlatLight = [f32; 17];

fn write_camera(to: &mut dyn Write, camera: &Camera, size: UVec2) -> io::Result<()> {
    let aspect = size.x as f32 / size.y as f32;
    write_vector(to, camera.eye)?;
    write_vector(to, camera.forward())?;
    write_vector(to, aspect * (camera.orientation * Vec3::X))?;
    write_vector(to, camera.orientation * Vec3::Y)?;
    to.write_all(&(0.5 * camera.vertical_fov).tan().to_le_bytes())
}

fn write_vector(to: &mut dyn Write, vector: Vec3) -> io::Result<()> {
    for value in vector.to_array() {
        to.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

fn push_light(lights: &mut Vec<FlatLight>, light: &Light) -> Result<(), PeerError> {
    let no_words = |what: &str| PeerError::Scene(format!("light '{}' is {what}", light.name));
    let (none, down) = (Vec3::ZERO, Vec3::NEG_Y);
    match &light.kind {
        &LightKind::Point {
            position,
            radiant_intensity,
        } => lights.push(flat(
            0.0,
            [position, down, radiant_intensity],
            -1.0,
            [none; 2],
        )),
        &LightKind::Spot {
            position,
            direction,
            radiant_intensity,
            cos_outer,
            ..
        } => {
            let place = [position, direction, radiant_intensity];
            lights.push(flat(1.0, place, cos_outer, [none; 2]));
        }
        LightKind::Directional { .. } => return Err(no_words("directional")),
        LightKind::Area(area) => {
            let sides = sides(area).ok_or_else(|| no_words("no parallelogram"))?;
            lights.extend(sides);
        }
    }
    Ok(())
}

/// A parallelogram shines to one side: where both do, there are two.
fn sides(area: &AreaLight) -> Option<Vec<FlatLight>> {
    let &AreaShape::Rectangle {
        corner,
        edge_u,
        edge_v,
    } = area.shape()
    else {
        return None;
    };
    let side = |edges| flat(2.0, [corner, Vec3::NEG_Y, area.radiance], -1.0, edges);
    let mut sides = vec![side([edge_u, edge_v])];
    if area.double_sided {
        sides.push(side([edge_v, edge_u]));
    }
    Some(sides)
}

/// `place` is position, direction and intensity or radiance.
fn flat(kind: f32, place: [Vec3; 3], cos_outer: f32, edges: [Vec3; 2]) -> FlatLight {
    let mut flat = [kind; 17];
    for (index, vector) in place.iter().enumerate() {
        flat[1 + 3 * index..][..3].copy_from_slice(&vector.to_array());
    }
    flat[10] = cos_outer;
    for (index, vector) in edges.iter().enumerate() {
        flat[11 + 3 * index..][..3].copy_from_slice(&vector.to_array());
    }
    flat
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::plain;

    #[test]
    fn every_number_of_a_scene_is_where_the_format_has_it() {
        let mut scene = plain(&lie_scene::cornell_box()).unwrap().scene;
        scene.lights.push(Light {
            name: "spot".to_owned(),
            kind: LightKind::Spot {
                position: Vec3::new(1.0, 2.0, 3.0),
                direction: Vec3::X,
                radiant_intensity: Vec3::splat(7.0),
                cos_inner: 0.75,
                cos_outer: 0.5,
            },
        });
        let mut bytes = vec![];
        let camera = scene.cameras[0].clone();
        write_flat(&mut bytes, &scene, &camera, UVec2::new(64, 32)).unwrap();
        let word = |index: usize| <[u8; 4]>::try_from(&bytes[4 * index..][..4]).unwrap();
        let number = |index: usize| f32::from_le_bytes(word(index));
        assert_eq!(&bytes[..4], b"LIEB");
        // The lamp's two triangles are not geometry.
        let counts: Vec<i32> = (1..7)
            .map(|index| i32::from_le_bytes(word(index)))
            .collect();
        let (vertices, triangles, materials) =
            (scene.geometry.vertices().len(), 34, scene.materials.len());
        assert_eq!(
            counts,
            [vertices as i32, triangles, materials as i32, 2, 64, 32]
        );
        // Camera: it looks along -z, and its right is twice as long as its up.
        assert_eq!([number(7), number(8), number(9)], [0.0, 2.75, 8.0]);
        assert!((number(12) + 1.0).abs() < 1.0e-6, "forward");
        assert!((number(13) - 2.0).abs() < 1.0e-6, "right");
        assert!((number(17) - 1.0).abs() < 1.0e-6, "up");
        assert!(
            (number(19) - 0.34_f32.tan()).abs() < 1.0e-6,
            "field of view"
        );
        let materials_at = 20 + 3 * vertices + 4 * triangles as usize;
        assert_eq!(number(materials_at), 0.73, "white's albedo");
        let lights_at = materials_at + 3 * materials;
        assert_eq!(bytes.len(), 4 * (lights_at + 2 * 17));
        assert_eq!([number(lights_at), number(lights_at + 7)], [2.0, 17.0]);
        let cross = Vec3::from_array([11, 12, 13].map(|index| number(lights_at + index))).cross(
            Vec3::from_array([14, 15, 16].map(|index| number(lights_at + index))),
        );
        assert!((cross.y + 1.365).abs() < 1.0e-3, "the lamp shines down");
        let spot: Vec<f32> = (0..17)
            .map(|index| number(lights_at + 17 + index))
            .collect();
        let expected = [1.0, 1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 7.0, 7.0, 7.0, 0.5];
        assert_eq!(spot[..11], expected);
        assert_eq!(spot[11..], [0.0; 6]);
    }

    #[test]
    fn what_the_format_cannot_say_is_an_error() {
        let mut scene = lie_scene::cornell_box();
        let camera = scene.cameras[0].clone();
        let write = |scene: &Scene, size| write_flat(&mut vec![], scene, &camera, size);
        let error = write(&scene, UVec2::new(64, 40)).unwrap_err();
        assert!(error.to_string().contains("multiple of 16"), "{error}");
        scene.lights[0].kind = LightKind::Directional {
            direction: Vec3::NEG_Y,
            irradiance: Vec3::ONE,
        };
        let error = write(&scene, UVec2::splat(64)).unwrap_err();
        assert!(error.to_string().contains("is directional"), "{error}");
    }

    #[test]
    fn what_shines_to_both_sides_is_two_lights() {
        let mut scene = lie_scene::cornell_box();
        let LightKind::Area(area) = &mut scene.lights[0].kind else {
            panic!("an area light");
        };
        area.double_sided = true;
        let both = sides(area).unwrap();
        assert_eq!(both.len(), 2);
        assert_eq!(both[0][11..14], both[1][14..17]);
        assert_eq!(both[0][14..17], both[1][11..14]);
    }
}
