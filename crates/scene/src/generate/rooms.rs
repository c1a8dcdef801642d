use glam::{Vec2, Vec3};

use super::{mesh::Mesh, shapes};
use crate::{Camera, Light, LightKind, Material, RenderSettings, Scene, draft::Draft};

/// What [`rooms`] is made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rooms {
    /// Closed rooms, at least one; they stand in a square grid.
    pub rooms: u32,
    /// Lights in each.
    pub lights_in_each: u32,
}

/// Sides of a room along x, y and z, in metres.
const ROOM: Vec3 = Vec3::new(8.0, 3.5, 8.0);
/// From one room to the next: there is a gap between their walls.
const STEP: f32 = 9.0;
/// Columns along each side of a room.
const COLUMNS: u32 = 3;

/// Closed rooms that are all alike, each with columns, a table and points of light. A room sees its
/// own lights and no others: its picture stays as it is, however many rooms there are. The
/// camera stands in the first.
///
/// # Panics
/// Never, for any parameters.
#[must_use]
pub fn rooms(parameters: &Rooms) -> Scene {
    let count = parameters.rooms.max(1);
    let mut draft = Draft::default();
    let white = draft.add_material(Material::diffuse("white", Vec3::splat(0.7)));
    let red = draft.add_material(Material::diffuse("red", Vec3::new(0.6, 0.2, 0.15)));
    let (shell, fittings) = (shell(), fittings());
    let columns = count.isqrt().max(1);
    for room in 0..count {
        let place = STEP * Vec3::new((room % columns) as f32, 0.0, -((room / columns) as f32));
        for (name, mesh, material) in [("shell", &shell, white), ("fittings", &fittings, red)] {
            let mut moved = Mesh::default();
            moved.add(mesh, glam::Quat::IDENTITY, place);
            moved.into_part(&mut draft, format!("{name} {room}"), material);
        }
        for light in 0..parameters.lights_in_each {
            draft.lights.push(Light {
                name: format!("light {room}.{light}"),
                kind: LightKind::Point {
                    position: place + light_position(light, parameters.lights_in_each),
                    radiant_intensity: Vec3::splat(40.0 / parameters.lights_in_each as f32),
                },
            });
        }
    }
    let (eye, target) = (Vec3::new(0.5, 1.7, -0.5), Vec3::new(5.0, 1.2, -5.0));
    let camera = Camera::look_at("first room", eye, target, Vec3::Y, 1.0);
    draft.cameras.push(camera);
    super::finish(draft, "rooms", RenderSettings::default())
}

/// Walls, floor and ceiling of the first room, seen from inside; its corner is the origin, and it
/// reaches along +x, +y and −z.
fn shell() -> Mesh {
    let mut mesh = Mesh::default();
    let (x, y, z) = (ROOM.x * Vec3::X, ROOM.y * Vec3::Y, -ROOM.z * Vec3::Z);
    mesh.block(Vec3::ZERO, x, y, z);
    mesh.flip();
    mesh
}

/// Columns and a table with balls.
fn fittings() -> Mesh {
    let mut mesh = Mesh::default();
    for index in 0..COLUMNS * COLUMNS {
        let at = Vec2::new((index % COLUMNS) as f32, (index / COLUMNS) as f32) + 1.0;
        let at = at / (COLUMNS + 1) as f32;
        let foot = Vec3::new(at.x * ROOM.x, 0.0, -at.y * ROOM.z);
        let column = shapes::rod(foot, foot + ROOM.y * Vec3::Y, 0.18, 24);
        mesh.add(&column, glam::Quat::IDENTITY, Vec3::ZERO);
        let ball = shapes::sphere(0.25, 16);
        let beside = foot + Vec3::new(0.7, 0.25, -0.6);
        mesh.add(&ball, glam::Quat::IDENTITY, beside);
    }
    mesh.cuboid(Vec3::new(2.6, 0.72, -3.6), Vec3::new(3.6, 0.78, -2.6));
    mesh.fill_normals();
    mesh
}

/// Places on a spiral below the ceiling.
fn light_position(index: u32, count: u32) -> Vec3 {
    const GOLDEN_ANGLE: f32 = 2.399_963;
    let share = ((index as f32 + 0.5) / count as f32).sqrt();
    let (sin, cos) = (index as f32 * GOLDEN_ANGLE).sin_cos();
    let center = Vec3::new(0.5 * ROOM.x, ROOM.y - 0.3, -0.5 * ROOM.z);
    center + share * Vec3::new(0.44 * ROOM.x * cos, 0.0, 0.44 * ROOM.z * sin)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rooms_grow_in_number_and_not_in_kind() {
        let (one, many) = (rooms_of(1), rooms_of(10));
        for scene in [&one, &many] {
            scene.validate().unwrap();
        }
        assert_eq!(many.geometry.len(), 10 * one.geometry.len());
        assert_eq!((one.lights.len(), many.lights.len()), (10, 100));
        assert_eq!(one.cameras, many.cameras);
        assert_eq!(one.lights[..], many.lights[..10]);
        let first = one.geometry.len();
        assert_eq!(one.geometry.shapes(), &many.geometry.shapes()[..first]);
        assert_eq!(rooms_of(0).lights.len(), 10);
    }

    #[test]
    fn lights_hang_in_their_room() {
        for light in rooms_of(1).lights {
            let LightKind::Point { position, .. } = light.kind else {
                panic!("a point");
            };
            assert!(
                position.cmpgt(Vec3::new(0.1, 3.0, -7.9)).all(),
                "{position}"
            );
            assert!(
                position.cmplt(Vec3::new(7.9, 3.4, -0.1)).all(),
                "{position}"
            );
        }
    }

    fn rooms_of(rooms: u32) -> Scene {
        super::rooms(&Rooms {
            rooms,
            lights_in_each: 10,
        })
    }
}
