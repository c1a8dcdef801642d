//! Models and lights in the text of files, and the scene that they make.

use std::{fmt::Write, sync::Arc};

use glam::Vec3;
use lie_render::World;

/// A model in the text of an OBJ file.
#[derive(Default)]
pub(crate) struct Model {
    text: String,
    vertices: usize,
}

impl Model {
    /// A polygon, as it is: nothing is checked.
    pub(crate) fn polygon(&mut self, corners: &[Vec3]) -> &mut Self {
        let mut face = "f".to_owned();
        for corner in corners {
            let [x, y, z] = corner.to_array();
            self.vertices += 1;
            writeln!(self.text, "v {x:?} {y:?} {z:?}").unwrap();
            write!(face, " {}", self.vertices).unwrap();
        }
        writeln!(self.text, "{face}").unwrap();
        self
    }

    /// A parallelogram.
    pub(crate) fn sheet(&mut self, corner: Vec3, u: Vec3, v: Vec3) -> &mut Self {
        self.polygon(&[corner, corner + u, corner + u + v, corner + v])
    }

    /// A parallelogram in `n × n` pieces that share their edges.
    pub(crate) fn tiles(&mut self, corner: Vec3, u: Vec3, v: Vec3, n: u32) -> &mut Self {
        let place = |i: u32, j: u32| corner + u * (i as f32 / n as f32) + v * (j as f32 / n as f32);
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            self.polygon(&[
                place(i, j),
                place(i + 1, j),
                place(i + 1, j + 1),
                place(i, j + 1),
            ]);
        }
        self
    }

    /// A closed box.
    pub(crate) fn solid(&mut self, min: Vec3, max: Vec3) -> &mut Self {
        let size = max - min;
        let [x, y, z] = [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z];
        self.sheet(min, y, x).sheet(min, z, y).sheet(min, x, z);
        self.sheet(max, -x, -y)
            .sheet(max, -y, -z)
            .sheet(max, -z, -x)
    }

    /// A floor of 8 × 8 m, in 64 pieces.
    pub(crate) fn floor(&mut self) -> &mut Self {
        self.tiles(Vec3::new(-4.0, 0.0, -4.0), Vec3::Z * 8.0, Vec3::X * 8.0, 8)
    }
}

pub(crate) fn point(position: [f32; 3], intensity: f32) -> String {
    format!(
        "[[light]]\nkind = \"point\"\nposition = {position:?}\nradiant_intensity = {:?}\n",
        [intensity; 3]
    )
}

pub(crate) fn spot(position: [f32; 3], target: [f32; 3], intensity: f32) -> String {
    format!(
        "[[light]]\nkind = \"spot\"\nposition = {position:?}\ntarget = {target:?}\n\
         inner_degrees = 20\nouter_degrees = 40\nradiant_intensity = {:?}\n",
        [intensity; 3]
    )
}

pub(crate) fn sun(direction: [f32; 3]) -> String {
    format!(
        "[[light]]\nkind = \"directional\"\ndirection = {direction:?}\nirradiance = [1, 1, 1]\n"
    )
}

/// A square of 1 m that shines down.
pub(crate) fn lamp(position: [f32; 3], radiance: f32) -> String {
    format!(
        "[[light]]\nkind = \"rectangle\"\nposition = {position:?}\ndirection = [0, -1, 0]\n\
         size_m = [1, 1]\nradiance = {:?}\n",
        [radiance; 3]
    )
}

/// The model under these lights, seen from these places.
pub(crate) fn world(
    model: &Model,
    lights: &[String],
    cameras: &[([f32; 3], [f32; 3])],
) -> Arc<World> {
    let home = tempfile::tempdir().unwrap();
    std::fs::write(home.path().join("model.obj"), &model.text).unwrap();
    let mut text = "[[geometry]]\nfile = \"model.obj\"\n".to_owned() + &lights.concat();
    for (number, (eye, target)) in cameras.iter().enumerate() {
        write!(
            text,
            "[[camera]]\nname = \"{number}\"\neye = {eye:?}\ntarget = {target:?}\n"
        )
        .unwrap();
    }
    let path = home.path().join("scene.toml");
    std::fs::write(&path, text + "[settings]\nlight_samples = 4\n").unwrap();
    Arc::new(World::new(Arc::new(lie_scene::load(&path).unwrap().scene)))
}
