//! The node tree: transforms, and what hangs on each node.

use glam::{Mat4, Vec3};
use gltf::json;

use super::Document;
use crate::{Camera, camera::orientation_towards, draft::Draft, load::LoadError};

impl Document<'_> {
    /// Adds what the scene's nodes carry.
    pub(super) fn add_nodes(&self, draft: &mut Draft) -> Result<(), LoadError> {
        let roots = self.roots()?;
        let nodes: Vec<_> = self.gltf.nodes().collect();
        let mut visited = vec![false; nodes.len()];
        // A stack of our own: a chain of nodes may be deeper than the thread's.
        let mut stack: Vec<(usize, Mat4)> = self
            .scene_nodes(&roots, draft)
            .into_iter()
            .rev()
            .map(|node| (node, Mat4::IDENTITY))
            .collect();
        while let Some((index, world_from_parent)) = stack.pop() {
            let node = &nodes[index];
            if std::mem::replace(&mut visited[index], true) {
                draft.warnings.push(format!(
                    "{} is in the scene twice; once counts",
                    label(node)
                ));
                continue;
            }
            let world_from_node =
                world_from_parent * Mat4::from_cols_array_2d(&node.transform().matrix());
            if !world_from_node.is_finite() {
                return Err(self.file.error(label(node), "its transform is not finite"));
            }
            if let Some(mesh) = node.mesh() {
                self.add_mesh(&mesh, &label(node), node.name(), world_from_node, draft)?;
            }
            if let Some(camera) = node.camera() {
                self.add_camera(&camera, node, world_from_node, draft)?;
            }
            if let Some(light) = node.light() {
                self.add_light(&light, node, world_from_node, draft)?;
            }
            let children = node
                .children()
                .map(|child| (child.index(), world_from_node));
            let first = stack.len();
            stack.extend(children);
            stack[first..].reverse();
        }
        Ok(())
    }

    /// Nodes without a parent. Every node must hang below one of them.
    fn roots(&self) -> Result<Vec<usize>, LoadError> {
        let nodes: Vec<_> = self.gltf.nodes().collect();
        let mut has_parent = vec![false; nodes.len()];
        for node in &nodes {
            for child in node.children() {
                if std::mem::replace(&mut has_parent[child.index()], true) {
                    return Err(self
                        .file
                        .error(label(&child), "it has more than one parent"));
                }
            }
        }
        let roots: Vec<_> = (0..nodes.len())
            .filter(|&index| !has_parent[index])
            .collect();
        let mut reached = vec![false; nodes.len()];
        let mut stack = roots.clone();
        while let Some(index) = stack.pop() {
            reached[index] = true;
            stack.extend(nodes[index].children().map(|child| child.index()));
        }
        match reached.iter().position(|&reached| !reached) {
            Some(index) => Err(self
                .file
                .error(label(&nodes[index]), "it is its own ancestor")),
            None => Ok(roots),
        }
    }

    /// The roots of the scene to show.
    fn scene_nodes(&self, roots: &[usize], draft: &mut Draft) -> Vec<usize> {
        let scene = self
            .gltf
            .default_scene()
            .or_else(|| self.gltf.scenes().next());
        let Some(scene) = scene else {
            draft
                .warnings
                .push("the file has no scene: all of its nodes are shown".into());
            return roots.to_vec();
        };
        if self.gltf.scenes().len() > 1 {
            let (index, count) = (scene.index(), self.gltf.scenes().len());
            draft
                .warnings
                .push(format!("scene {index} of {count} is shown"));
        }
        scene.nodes().map(|node| node.index()).collect()
    }

    fn add_camera(
        &self,
        camera: &gltf::Camera<'_>,
        node: &gltf::Node<'_>,
        world_from_node: Mat4,
        draft: &mut Draft,
    ) -> Result<(), LoadError> {
        let element = || format!("camera {} at {}", camera.index(), label(node));
        let json: &json::Camera = &self.gltf.as_json().cameras[camera.index()];
        let Some(perspective) = &json.perspective else {
            draft.warnings.push(format!(
                "{} is not a perspective one and left out",
                element()
            ));
            return Ok(());
        };
        if !(perspective.yfov > 0.0 && perspective.yfov < std::f32::consts::PI) {
            let problem = format!("a yfov of {} is outside 0 to π", perspective.yfov);
            return Err(self.file.error(element(), problem));
        }
        let eye = world_from_node.transform_point3(Vec3::ZERO);
        let name = camera
            .name()
            .or(node.name())
            .map_or_else(|| format!("camera {}", draft.cameras.len()), str::to_owned);
        draft.cameras.push(Camera {
            name,
            eye,
            orientation: orientation_towards(
                world_from_node.transform_vector3(Vec3::NEG_Z),
                world_from_node.transform_vector3(Vec3::Y),
            ),
            vertical_fov: perspective.yfov,
        });
        Ok(())
    }
}

/// How messages name a node.
pub(super) fn label(node: &gltf::Node<'_>) -> String {
    match node.name() {
        Some(name) => format!(
            "node {} '{}'",
            node.index(),
            crate::load::source::shorten(name)
        ),
        None => format!("node {}", node.index()),
    }
}
