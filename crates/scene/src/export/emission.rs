//! Which lights a file holds already, as emissive surfaces.

use std::collections::HashSet;

use crate::{AreaLight, LightKind, Scene, area_shape::area_shape};

/// The area lights that no emissive mesh part stands for, with their index: they have to be
/// written as surfaces of their own.
pub(super) fn lights_without_surface(scene: &Scene) -> Vec<(usize, &AreaLight)> {
    let mut shown: Vec<AreaLight> = scene
        .geometry
        .parts()
        .iter()
        .filter_map(|part| {
            let material = &scene.materials[part.material as usize];
            let corners = part.triangles.clone().map(|index| {
                let triangle = scene.geometry.triangle(index);
                [triangle.a, triangle.b, triangle.c]
            });
            material.is_emissive().then(|| {
                AreaLight::new(
                    area_shape(corners.collect()),
                    material.emission,
                    material.double_sided,
                )
            })
        })
        .collect();
    let mut hidden = Vec::new();
    for (index, light) in scene.lights.iter().enumerate() {
        let LightKind::Area(area) = &light.kind else {
            continue;
        };
        // Each surface stands for one light.
        match shown.iter().position(|shown| same(shown, area)) {
            Some(place) => {
                shown.swap_remove(place);
            }
            None => hidden.push((index, area)),
        }
    }
    hidden
}

/// Whether two lights shine alike: the same corners, whatever their order.
fn same(a: &AreaLight, b: &AreaLight) -> bool {
    let corners = |light: &AreaLight| -> HashSet<[u32; 3]> {
        let triangles = light.triangles().iter();
        triangles
            .flat_map(|triangle| [triangle.a, triangle.b, triangle.c])
            .map(|corner| {
                (corner + 0.0)
                    .to_array()
                    .map(|x| ((x * 1.0e4).round() as i32) as u32)
            })
            .collect()
    };
    a.radiance == b.radiance
        && a.double_sided == b.double_sided
        && a.triangles().len() == b.triangles().len()
        && (a.area() - b.area()).abs() <= 1.0e-4 * a.area()
        && corners(a) == corners(b)
}
