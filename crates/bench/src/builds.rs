//! What the scenes' acceleration structures take: time to be built, and memory.

use std::{sync::Arc, time::Instant};

use lie_accel::Cutout;
use lie_render::AccelKind;
use lie_scene::Material;
use serde_json::{Value, json};

use crate::{
    Progress, Section, Spread, Stage, Table,
    race::milliseconds,
    table::{memory, ms},
};

/// The structure of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct BuildRow {
    /// The scene's name.
    pub scene: String,
    /// What it was loaded from.
    pub path: String,
    /// The structure.
    pub accel: AccelKind,
    /// Threads that built it.
    pub threads: usize,
    /// Lights of the scene.
    pub lights: usize,
    /// Triangles of the scene.
    pub triangles: usize,
    /// Times in which it was built, from triangles to the first ray, in milliseconds.
    pub build_ms: Spread,
    /// Its memory in bytes.
    pub bytes: usize,
}

impl BuildRow {
    /// Nanoseconds for each triangle; 0 if there are none.
    fn ns_by_triangle(&self) -> f64 {
        1.0e6 * self.build_ms.median / self.triangles.max(1) as f64
    }

    /// Bytes for each triangle.
    fn bytes_by_triangle(&self) -> f64 {
        self.bytes as f64 / self.triangles.max(1) as f64
    }
}

/// Builds a stage's structure anew `repeat` times (at least once), on rayon's current threads.
#[must_use]
pub fn measure(stage: &Stage, repeat: u32, progress: &Progress<'_>) -> BuildRow {
    let scene = stage.scene();
    let has_holes = scene.materials.iter().any(Material::is_masked);
    let repeat = repeat.max(1);
    let what = format!("{}: build", stage.name());
    let mut times = vec![];
    for repetition in 0..repeat {
        progress(&what, repetition as f32 / repeat as f32);
        let cutout = has_holes.then(|| scene.clone() as Arc<dyn Cutout>);
        let clock = Instant::now();
        let built = stage.accel().build(&scene.geometry, cutout);
        times.push(milliseconds(clock.elapsed()));
        drop(built);
    }
    BuildRow {
        scene: stage.name().to_owned(),
        path: stage.path().to_owned(),
        accel: stage.accel(),
        threads: rayon::current_num_threads(),
        lights: scene.lights.len(),
        triangles: scene.geometry.len(),
        build_ms: Spread::of(&times).unwrap_or(Spread::NONE),
        bytes: stage.world().accel().bytes(),
    }
}

/// The table.
#[must_use]
pub fn table(rows: &[BuildRow]) -> Table {
    let numbers = [
        "threads",
        "lights",
        "triangles",
        "build ms",
        "min",
        "max",
        "ns/triangle",
        "memory",
        "bytes/triangle",
    ];
    let mut table = Table::new(&["scene", "structure"], &numbers);
    for row in rows {
        table.push([
            row.scene.clone(),
            row.accel.name().to_owned(),
            row.threads.to_string(),
            row.lights.to_string(),
            row.triangles.to_string(),
            ms(row.build_ms.median),
            ms(row.build_ms.min),
            ms(row.build_ms.max),
            format!("{:.0}", row.ns_by_triangle()),
            memory(row.bytes as u64),
            format!("{:.0}", row.bytes_by_triangle()),
        ]);
    }
    table
}

/// The rows as JSON.
#[must_use]
pub fn json(rows: &[BuildRow]) -> Value {
    let row_json = |row: &BuildRow| {
        json!({
            "scene": row.scene,
            "path": row.path,
            "accel": row.accel.name(),
            "threads": row.threads,
            "lights": row.lights,
            "triangles": row.triangles,
            "build_ms": row.build_ms.median,
            "build_ms_min": row.build_ms.min,
            "build_ms_max": row.build_ms.max,
            "accel_bytes": row.bytes,
        })
    };
    rows.iter().map(row_json).collect()
}

/// The section of a report.
#[must_use]
pub fn section(rows: &[BuildRow]) -> Section {
    let about = "From a scene's triangles to the structure that serves its rays, on all threads; \
                 loading is not counted, nor is the construction of LIEs. Times are medians of builds \
                 one after the other, and no part of any frame's. *Memory* is that of the \
                 structure, with the copies of triangles in it.";
    Section {
        heading: "Building the acceleration structure".to_owned(),
        paragraphs: vec![about.to_owned()],
        tables: vec![table(rows)],
        ..Section::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    #[test]
    fn a_structure_is_built_anew_and_weighed() {
        for accel in [AccelKind::Bvh, AccelKind::Grid] {
            let scene = Arc::new(lie_scene::cornell_box());
            let camera = scene.cameras[0].clone();
            let stage = Stage::new("made", scene.clone(), camera, UVec2::splat(8), accel);
            let row = measure(&stage, 3, &|_, _| {});
            assert_eq!(row.triangles, scene.geometry.len());
            assert!(row.bytes > 36 * row.triangles, "{row:?}");
            assert!(0.0 < row.build_ms.min && row.build_ms.min <= row.build_ms.median);
            let json = &json(std::slice::from_ref(&row))[0];
            assert_eq!(json["accel"], accel.name());
            assert_eq!(json["accel_bytes"], row.bytes);
            let text = table(&[row]).text();
            assert!(text.contains(accel.name()), "{text}");
        }
    }
}
