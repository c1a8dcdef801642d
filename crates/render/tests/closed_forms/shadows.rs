//! Where shadows lie.

use glam::{Vec2, Vec3};
use lie_render::World;
use lie_scene::{AlphaMode, LightKind, Material, Texture, TextureRef};

use crate::stage::{Stage, seen_exactly};

const LIGHT: Vec3 = Vec3::new(0.4, 5.0, -0.3);
/// Below the square, so that it hides nothing.
const EYE: Vec3 = Vec3::new(9.0, 1.5, 7.0);
const HEIGHT: f32 = 2.0;

/// A floor and a point light, with a square of side 2 in between, at [`HEIGHT`].
fn shaded_by(square: Material, textures: Vec<Texture>) -> World {
    let corner = Vec3::new(-1.0, HEIGHT, -1.0);
    let mut stage = Stage::default()
        .floor(Material::default())
        .quad(square, corner, 2.0 * Vec3::X, 2.0 * Vec3::Z)
        .light(LightKind::Point {
            position: LIGHT,
            radiant_intensity: Vec3::ONE,
        });
    stage.textures = textures;
    stage.world()
}

/// Where the light throws a point of the square's plane on the floor.
fn thrown(x: f32, z: f32) -> Vec3 {
    let at = Vec3::new(x, HEIGHT, z);
    LIGHT + (at - LIGHT) * LIGHT.y / (LIGHT.y - HEIGHT)
}

#[test]
fn a_hard_shadow_ends_where_similar_triangles_say() {
    let world = shaded_by(Material::default(), vec![]);
    let is_lit = |x, z| seen_exactly(&world, EYE, thrown(x, z)) != Vec3::ZERO;
    let step = 1.0e-4;
    for along in [-0.99, -0.5, 0.0, 0.3, 0.99] {
        for edge in [-1.0f32, 1.0] {
            let (inside, outside) = (edge * (1.0 - step), edge * (1.0 + step));
            assert!(
                !is_lit(inside, along) && is_lit(outside, along),
                "{edge}, {along}"
            );
            assert!(
                !is_lit(along, inside) && is_lit(along, outside),
                "{along}, {edge}"
            );
        }
        assert!(!is_lit(along, along), "the inside is dark");
        assert!(is_lit(along + 3.0, along), "the outside is lit");
    }
}

#[test]
fn no_light_leaks_through_the_diagonal_of_a_square() {
    // Two triangles meet there: rays at their common edge hit one of them.
    let world = shaded_by(Material::default(), vec![]);
    for i in -999..1000 {
        let x = i as f32 * 1.0e-3;
        assert_eq!(seen_exactly(&world, EYE, thrown(x, x)), Vec3::ZERO, "{x}");
    }
}

#[test]
fn a_masked_occluder_throws_a_shadow_with_holes() {
    // Opaque where x and z have one sign, else a hole: the texture's first row is at z = −1.
    let texel = |alpha| [255, 255, 255, alpha];
    let texels = vec![texel(255), texel(0), texel(0), texel(255)];
    let texture = Texture::new(2, 2, true, texels).unwrap();
    let mask = Material {
        base_color_texture: Some(TextureRef::plain(0)),
        alpha_mode: AlphaMode::Mask { cutoff: 0.5 },
        ..Material::default()
    };
    let world = shaded_by(mask, vec![texture]);
    for (x, z) in [(-0.5, -0.5), (0.5, -0.5), (-0.5, 0.5), (0.5, 0.5)] {
        for offset in [Vec2::ZERO, Vec2::new(0.2, -0.15), Vec2::new(-0.1, 0.2)] {
            let at = Vec2::new(x, z) + offset;
            let found = seen_exactly(&world, EYE, thrown(at.x, at.y));
            let is_hole = x * z < 0.0;
            assert_eq!(found != Vec3::ZERO, is_hole, "below {at}");
        }
    }
}

#[test]
fn a_light_between_floor_and_square_is_not_shaded() {
    let world = Stage::default()
        .floor(Material::default())
        .quad(
            Material::default(),
            Vec3::new(-1.0, HEIGHT, -1.0),
            2.0 * Vec3::X,
            2.0 * Vec3::Z,
        )
        .light(LightKind::Point {
            position: Vec3::new(0.0, HEIGHT - 1.0e-3, 0.0),
            radiant_intensity: Vec3::ONE,
        })
        .world();
    for x in [0.0, 0.5, 4.0] {
        let eye = Vec3::new(9.0, 1.0, 0.0);
        assert_ne!(
            seen_exactly(&world, eye, Vec3::new(x, 0.0, 0.0)),
            Vec3::ZERO
        );
    }
}
