use std::{collections::HashMap, fmt::Write};

use super::{Exported, ObjText, emission::lights_without_surface};
use crate::{LightKind, Material, MeshPart, Scene};

/// Writes a scene as OBJ, with a material library under the given file name.
///
/// Triangles, materials and emissive surfaces survive; lights without a surface, cameras
/// and textures do not, and each loss is a warning.
#[must_use]
pub fn export_obj(scene: &Scene, mtl_file_name: &str) -> Exported<ObjText> {
    let names = material_names(scene);
    let mut text = Text {
        obj: format!("mtllib {mtl_file_name}\n"),
        counts: [1; 3],
    };
    for (index, part) in scene.geometry.parts().iter().enumerate() {
        // Parts of one name and material would become one, and their lights with them.
        let name = format!("{}.{index}", single_line(&part.name));
        text.add_part(scene, part, &name, &names[part.material as usize]);
    }
    let content = ObjText {
        obj: text.obj,
        mtl: library(scene, &names),
    };
    Exported {
        content,
        warnings: lost(scene),
    }
}

/// What OBJ has no place for.
fn lost(scene: &Scene) -> Vec<String> {
    let without_surface = scene
        .lights
        .iter()
        .filter(|light| !matches!(light.kind, LightKind::Area(_)))
        .count()
        + lights_without_surface(scene).len();
    let two_sided = scene
        .materials
        .iter()
        .filter(|m| m.is_emissive() && m.double_sided)
        .count();
    [
        (without_surface, "lights without a surface are not written"),
        (scene.cameras.len(), "cameras are not written"),
        (scene.walkthroughs.len(), "walkthroughs are not written"),
        (
            scene.textures.len(),
            "textures are not written: materials keep their colour alone",
        ),
        (
            two_sided,
            "materials that shine from both sides do so from the front alone",
        ),
    ]
    .into_iter()
    .filter(|(count, _)| *count > 0)
    .map(|(count, what)| format!("{count} {what}"))
    .collect()
}

/// A name of its own for each material.
fn material_names(scene: &Scene) -> Vec<String> {
    let mut seen: HashMap<&str, usize> = HashMap::new();
    scene
        .materials
        .iter()
        .enumerate()
        .map(|(index, material)| {
            let count = seen.entry(&material.name).or_insert(0);
            *count += 1;
            let name = single_line(&material.name);
            if *count == 1 && !name.is_empty() {
                name
            } else {
                format!("{name}.{index}")
            }
        })
        .collect()
}

/// A name without what ends or comments a line.
fn single_line(name: &str) -> String {
    let clean = |c: char| {
        if c.is_control() || c == '#' || c == '\\' {
            '_'
        } else {
            c
        }
    };
    name.trim().chars().map(clean).collect()
}

struct Text {
    obj: String,
    /// Number of the next position, texture coordinate and normal.
    counts: [usize; 3],
}

impl Text {
    fn add_part(&mut self, scene: &Scene, part: &MeshPart, name: &str, material: &str) {
        let range = part.triangles.start as usize..part.triangles.end as usize;
        let triangles = &scene.geometry.triangles()[range];
        let mut used = Vec::new();
        let mut own: HashMap<u32, usize> = HashMap::new();
        for &index in triangles.iter().flatten() {
            own.entry(index).or_insert_with(|| {
                used.push(scene.geometry.vertices()[index as usize]);
                used.len() - 1
            });
        }
        let mut line = |arguments: std::fmt::Arguments<'_>| {
            // Writing to a string cannot fail.
            let _ = writeln!(self.obj, "{arguments}");
        };
        line(format_args!("o {name}"));
        line(format_args!("usemtl {material}"));
        for vertex in &used {
            let [x, y, z] = vertex.position.to_array();
            line(format_args!("v {x} {y} {z}"));
        }
        for vertex in &used {
            line(format_args!("vt {} {}", vertex.uv.x, 1.0 - vertex.uv.y));
        }
        let mut normal_of = vec![None; used.len()];
        let mut normals = 0;
        for (index, vertex) in used
            .iter()
            .enumerate()
            .filter(|(_, v)| v.normal != glam::Vec3::ZERO)
        {
            let [x, y, z] = vertex.normal.to_array();
            line(format_args!("vn {x} {y} {z}"));
            normal_of[index] = Some(self.counts[2] + normals);
            normals += 1;
        }
        for triangle in triangles {
            let corner = |index: u32| {
                let place = own[&index];
                let (position, uv) = (self.counts[0] + place, self.counts[1] + place);
                match normal_of[place] {
                    Some(normal) => format!("{position}/{uv}/{normal}"),
                    None => format!("{position}/{uv}"),
                }
            };
            let [a, b, c] = triangle.map(corner);
            line(format_args!("f {a} {b} {c}"));
        }
        self.counts[0] += used.len();
        self.counts[1] += used.len();
        self.counts[2] += normals;
    }
}

fn library(scene: &Scene, names: &[String]) -> String {
    let mut mtl = String::new();
    for (material, name) in scene.materials.iter().zip(names) {
        let Material {
            base_color: kd,
            emission: ke,
            specular,
            roughness,
            metallic,
            ..
        } = material;
        let _ = write!(
            mtl,
            "newmtl {name}\nKd {} {} {}\nKs {specular} {specular} {specular}\nKe {} {} {}\n\
             Pr {roughness}\nPm {metallic}\nd {}\n\n",
            kd.x, kd.y, kd.z, ke.x, ke.y, ke.z, material.alpha,
        );
    }
    mtl
}
