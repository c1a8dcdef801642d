//! MTL files, and what their numbers mean here.
//!
//! | MTL | material |
//! |---|---|
//! | `Kd`, `map_Kd` | base colour (white under a texture if `Kd` is black or absent) |
//! | `Ks` | specular 1 where any channel is above 0, else 0: a pure Lambertian surface |
//! | `Ns` | roughness `(2 / (Ns + 2))^¼`, so that GGX α is that of the Phong exponent |
//! | `Pr`, `Pm` | roughness and metallic; `Pm` above ½ takes its colour from `Ks` if `Kd` is black |
//! | `Ke` | emission, from the front |
//! | `d`, `Tr`, `map_d` | alpha; below 1, or with `map_d`, a mask at ½ |

use std::{collections::HashSet, path::Path};

use glam::Vec3;

use super::scan::{self, Place};
use crate::{
    AlphaMode, Material, TextureRef,
    draft::Draft,
    load::{LoadError, MAX_TEXTURE_BYTES, picture, source},
};

/// Reads all material libraries, each line checked. A missing one is a warning.
pub(super) fn read_libraries(
    path: &Path,
    libraries: &[String],
    draft: &mut Draft,
) -> Result<Vec<tobj::Material>, LoadError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut materials: Vec<tobj::Material> = Vec::new();
    let mut names = HashSet::new();
    for argument in libraries {
        for name in library_names(argument, folder) {
            let Ok(file) = source::relative_file(&name, folder) else {
                let name = source::shorten(&name);
                draft
                    .warnings
                    .push(format!("material library '{name}' is not a relative path"));
                continue;
            };
            let bytes = match source::read(&file) {
                Ok(bytes) => bytes,
                Err(error) => {
                    draft.warnings.push(format!("material library: {error}"));
                    continue;
                }
            };
            let text = clean(&file, &scan::decode(&file, &bytes)?)?;
            let (read, _) =
                tobj::load_mtl_buf(&mut text.as_bytes()).map_err(|error| LoadError::Element {
                    path: file.clone(),
                    element: "MTL".into(),
                    problem: error.to_string(),
                })?;
            // The first definition of a name counts.
            materials.extend(
                read.into_iter()
                    .filter(|new| names.insert(new.name.clone())),
            );
        }
    }
    Ok(materials)
}

/// The file names of a `mtllib`: one name with spaces if there is such a file, else several
/// names parted by spaces, where `\ ` is a space in a name.
fn library_names(argument: &str, folder: &Path) -> Vec<String> {
    let whole = source::relative_file(argument, folder);
    if whole.is_ok_and(|file| file.is_file()) {
        return vec![argument.to_owned()];
    }
    let names: Vec<String> = argument
        .replace("\\ ", "\0")
        .split_whitespace()
        .map(|name| name.replace('\0', " "))
        .collect();
    let found =
        |name: &&String| source::relative_file(name, folder).is_ok_and(|file| file.is_file());
    // Of several alternatives those count that are there.
    match names.iter().filter(found).count() {
        0 => vec![argument.to_owned()],
        _ => names.iter().filter(found).cloned().collect(),
    }
}

/// Keeps the lines that count, with their numbers checked: tobj gives up on a whole file
/// for a line it does not like.
fn clean(path: &Path, text: &str) -> Result<String, LoadError> {
    let mut kept = String::new();
    for (index, line) in text.lines().enumerate() {
        let at = Place {
            path,
            line,
            number: index + 1,
        };
        let content = line.trim();
        let (keyword, rest) = content
            .split_once(char::is_whitespace)
            .unwrap_or((content, ""));
        let before_comment = rest.split('#').next().unwrap_or_default();
        let rest = rest.trim();
        match keyword {
            "newmtl" => {
                let name = if rest.is_empty() { "unnamed" } else { rest };
                kept.push_str(&format!("newmtl {name}\n"));
            }
            "Kd" | "Ks" | "Ke" | "Ns" | "d" | "Tr" | "Pr" | "Pm" => {
                let mut numbers = Vec::new();
                for word in before_comment.split_whitespace() {
                    match word.parse::<f32>() {
                        Ok(number) if number.is_finite() => numbers.push(number),
                        // Spectra and `-halo` are not numbers: the line does not count.
                        _ if numbers.is_empty()
                            && word.starts_with(char::is_alphabetic)
                            && word != "nan"
                            && word != "inf" =>
                        {
                            break;
                        }
                        _ if word.starts_with('-')
                            && word[1..].starts_with(char::is_alphabetic)
                            && word != "-nan"
                            && word != "-inf" =>
                        {
                            numbers.clear()
                        }
                        _ => {
                            return Err(at.error(
                                Some(word),
                                &format!(
                                    "expected a finite number, found '{}'",
                                    source::shorten(word)
                                ),
                            ));
                        }
                    }
                }
                match (keyword.starts_with('K'), numbers.as_slice()) {
                    (_, []) => {}
                    (true, &[r, g, b, ..]) => kept.push_str(&format!("{keyword} {r} {g} {b}\n")),
                    (true, &[grey]) => kept.push_str(&format!("{keyword} {grey} {grey} {grey}\n")),
                    (true, _) => {
                        return Err(
                            at.error(None, &format!("expected 3 numbers after '{keyword}'"))
                        );
                    }
                    (false, &[number, ..]) => kept.push_str(&format!("{keyword} {number}\n")),
                }
            }
            "map_Kd" | "map_d" if !rest.is_empty() => {
                kept.push_str(&format!("{keyword} {}\n", file_name(rest)));
            }
            _ => {}
        }
    }
    Ok(kept)
}

/// A texture's file name, which may hold spaces, without the options before it.
fn file_name(argument: &str) -> &str {
    let mut rest = argument;
    while rest.starts_with('-') {
        let after_option = rest
            .split_once(char::is_whitespace)
            .map_or("", |(_, after)| after);
        rest = after_option.trim_start();
        while let Some((word, after)) = rest.split_once(char::is_whitespace) {
            if word.parse::<f32>().is_err() && word != "on" && word != "off" {
                break;
            }
            rest = after.trim_start();
        }
    }
    if rest.is_empty() { argument } else { rest }
}

/// Adds the materials, in the order tobj knows them by.
pub(super) fn add(
    library: Vec<tobj::Material>,
    path: &Path,
    draft: &mut Draft,
) -> Result<(), LoadError> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut known: Vec<(String, Option<u32>)> = Vec::new();
    for material in library {
        let number = |key: &str| material.unknown_param.get(key)?.parse::<f32>().ok();
        let color = |value: Option<[f32; 3]>| value.map(Vec3::from);
        let ks = color(material.specular).unwrap_or(Vec3::ZERO);
        let mut texture = None;
        if let Some(name) = &material.diffuse_texture {
            texture = match known.iter().find(|(known, _)| known == name) {
                Some((_, index)) => *index,
                None => {
                    let index = add_texture(name, folder, draft)?;
                    known.push((name.clone(), index));
                    index
                }
            };
        }
        if material.dissolve_texture.is_some()
            && material.dissolve_texture != material.diffuse_texture
        {
            draft
                .warnings
                .push("map_d counts only where it is the same image as map_Kd".into());
        }
        let kd = color(material.diffuse);
        let metallic = number("Pm").unwrap_or(0.0).clamp(0.0, 1.0);
        let base_color = match (kd, texture) {
            (None | Some(Vec3::ZERO), Some(_)) => Vec3::ONE,
            (None | Some(Vec3::ZERO), None) if metallic > 0.5 => ks,
            (kd, _) => kd.unwrap_or(Material::default().base_color),
        };
        let shininess = material.shininess.unwrap_or(0.0).max(0.0);
        let roughness = number("Pr").unwrap_or((2.0 / (shininess + 2.0)).powf(0.25));
        let alpha = material
            .dissolve
            .or(number("Tr").map(|tr| 1.0 - tr))
            .unwrap_or(1.0);
        let is_cut = alpha < 1.0 || (material.dissolve_texture.is_some() && texture.is_some());
        if alpha < 1.0 {
            draft.warnings.push(format!(
                "material '{}': transparency is replaced by a mask at alpha 0.5",
                source::shorten(&material.name)
            ));
        }
        draft.materials.push(Material {
            name: material.name.clone(),
            base_color: base_color.clamp(Vec3::ZERO, Vec3::ONE),
            base_color_texture: texture.map(TextureRef::plain),
            alpha: alpha.clamp(0.0, 1.0),
            metallic,
            roughness: roughness.clamp(0.0, 1.0),
            specular: if ks.max_element() > 0.0 { 1.0 } else { 0.0 },
            emission: color(material.emissive)
                .unwrap_or(Vec3::ZERO)
                .max(Vec3::ZERO),
            alpha_mode: if is_cut {
                AlphaMode::Mask { cutoff: 0.5 }
            } else {
                AlphaMode::Opaque
            },
            ..Material::default()
        });
    }
    Ok(())
}

/// Decodes a texture; one that is missing or broken is a warning.
fn add_texture(name: &str, folder: &Path, draft: &mut Draft) -> Result<Option<u32>, LoadError> {
    let read = source::relative_file(name, folder).and_then(|file| {
        source::read(&file)
            .map_err(|error| error.to_string())
            .and_then(|bytes| {
                picture::decode(&bytes, true)
                    .map_err(|problem| format!("{}: {problem}", file.display()))
            })
    });
    let texture = match read {
        Ok(texture) => texture,
        Err(problem) => {
            draft
                .warnings
                .push(format!("texture {problem}; the colour alone is used"));
            return Ok(None);
        }
    };
    let held: usize = draft
        .textures
        .iter()
        .map(|texture| texture.texels().len() * 4)
        .sum();
    if held + texture.texels().len() * 4 > MAX_TEXTURE_BYTES {
        draft.warnings.push(format!(
            "texture '{name}': all together exceed {MAX_TEXTURE_BYTES} bytes; left out"
        ));
        return Ok(None);
    }
    draft.textures.push(texture);
    Ok(Some(draft.textures.len() as u32 - 1))
}
