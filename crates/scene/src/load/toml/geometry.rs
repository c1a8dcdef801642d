//! `[[geometry]]` and `[[material]]`.

use std::path::Path;

use glam::{EulerRot, Mat4, Quat, Vec3};
use toml::Spanned;

use super::schema::{GeometryEntry, MaterialEntry, Problem, Rotation, Scale};
use crate::{
    AlphaMode,
    draft::Draft,
    generate,
    load::{LoadError, read_model, source},
};

/// Adds the geometry that an entry names.
pub(super) fn add(
    entry: &Spanned<GeometryEntry>,
    path: &Path,
    at: &dyn Fn(Problem) -> LoadError,
    draft: &mut Draft,
) -> Result<(), LoadError> {
    let geometry = entry.as_ref();
    let here = |problem: &str| at((entry.span(), problem.to_owned()));
    let mut added = match (&geometry.file, &geometry.generator) {
        (Some(file), None) => {
            if geometry.seed.is_some() || geometry.detail.is_some() {
                return Err(here("seed and detail belong to a generator, not to a file"));
            }
            let folder = path.parent().unwrap_or(Path::new(""));
            let file = source::relative_file(file, folder).map_err(|problem| here(&problem))?;
            // The message names both: the file that fails, and who asked for it.
            read_model(&file).map_err(|error| here(&format!("geometry: {error}")))?
        }
        (None, Some(generator)) => generated(geometry, generator).map_err(at)?,
        _ => return Err(here("expected either file or generator")),
    };
    if !geometry.keep_lights {
        added.lights.clear();
        added
            .materials
            .iter_mut()
            .for_each(|material| material.emission = Vec3::ZERO);
    }
    if !geometry.keep_cameras {
        added.cameras.clear();
        added.walkthroughs.clear();
    }
    let placement = placement(geometry);
    if !placement.is_finite() {
        return Err(here("expected a finite translation, rotation and scale"));
    }
    if placement.determinant() == 0.0 {
        return Err(here("expected a scale other than 0"));
    }
    if placement != Mat4::IDENTITY {
        added.transform(placement);
    }
    draft.append(added);
    Ok(())
}

fn generated(geometry: &GeometryEntry, generator: &Spanned<String>) -> Result<Draft, Problem> {
    let detail = geometry.detail.map_or(1.0, |detail| detail.0);
    let seed = geometry.seed.unwrap_or(1);
    match generator.as_ref().as_str() {
        "cornell-box" if geometry.seed.is_some() || geometry.detail.is_some() => Err((
            generator.span(),
            "the Cornell box is always the same: it takes no seed and no detail".into(),
        )),
        "cornell-box" => Ok(generate::cornell_draft()),
        "gallery" => Ok(generate::gallery_draft(&generate::Gallery { seed, detail })),
        "mosque" => Ok(generate::mosque_draft(&generate::Mosque { seed, detail })),
        "science-center" => {
            let parameters = generate::ScienceCenter { seed, detail };
            Ok(generate::science_center_draft(&parameters))
        }
        "bar" => Ok(generate::bar_draft(&generate::Bar { seed, detail })),
        other => Err((
            generator.span(),
            format!(
                "expected the generator \"cornell-box\", \"gallery\", \"bar\", \"mosque\" or \
                 \"science-center\", found \"{}\"",
                source::shorten(other)
            ),
        )),
    }
}

fn placement(geometry: &GeometryEntry) -> Mat4 {
    let rotation = match geometry.rotation_degrees {
        None => Quat::IDENTITY,
        Some(Rotation::About(degrees)) => {
            let axis = geometry.rotation_axis.map_or(Vec3::Y, |axis| axis.0);
            Quat::from_axis_angle(axis.normalize_or(Vec3::Y), degrees.to_radians())
        }
        Some(Rotation::Euler(degrees)) => {
            let [x, y, z] = degrees.map(f32::to_radians);
            Quat::from_euler(EulerRot::ZYX, z, y, x)
        }
    };
    let scale = match geometry.scale {
        None => Vec3::ONE,
        Some(Scale::Uniform(scale)) => Vec3::splat(scale),
        Some(Scale::PerAxis(scale)) => Vec3::from(scale),
    };
    let translation = geometry
        .translation
        .map_or(Vec3::ZERO, |translation| translation.0);
    Mat4::from_scale_rotation_translation(scale, rotation, translation)
}

/// Gives all materials of a name the values that an entry states.
pub(super) fn override_material(
    entry: &Spanned<MaterialEntry>,
    draft: &mut Draft,
) -> Result<(), Problem> {
    let new = entry.as_ref();
    let mut found = false;
    for material in draft
        .materials
        .iter_mut()
        .filter(|material| material.name == new.name)
    {
        found = true;
        if let Some(color) = new.base_color {
            material.base_color = color.0;
        }
        for (value, new) in [
            (&mut material.alpha, new.alpha),
            (&mut material.metallic, new.metallic),
            (&mut material.roughness, new.roughness),
            (&mut material.specular, new.specular),
        ] {
            if let Some(new) = new {
                *value = new.0;
            }
        }
        if let Some(emission) = new.emission {
            material.emission = emission.0;
        }
        if let Some(double_sided) = new.double_sided {
            material.double_sided = double_sided;
        }
        match new.alpha_cutoff {
            Some(cutoff) if cutoff.0 > 0.0 => {
                material.alpha_mode = AlphaMode::Mask { cutoff: cutoff.0 }
            }
            Some(_) => material.alpha_mode = AlphaMode::Opaque,
            None => {}
        }
    }
    if found {
        Ok(())
    } else {
        Err((entry.span(), no_such_material(&new.name, draft)))
    }
}

/// Says that a material is not there, and which are.
pub(super) fn no_such_material(name: &str, draft: &Draft) -> String {
    let known: Vec<&str> = draft
        .materials
        .iter()
        .map(|material| material.name.as_str())
        .take(20)
        .collect();
    format!(
        "no material is named \"{}\"; there are: {}",
        source::shorten(name),
        known.join(", ")
    )
}
