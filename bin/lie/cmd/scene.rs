use clap::Subcommand;

/// Looks at scenes and converts them.
#[derive(Subcommand)]
pub(crate) enum SceneCommand {
    /// Prints counts, bounds, lights, cameras and walkthroughs.
    Info {
        /// A scene: .toml, .glb, .gltf or .obj, or a folder with a scene.toml.
        scene: std::path::PathBuf,
    },
}

pub(crate) fn execute(command: &SceneCommand) -> anyhow::Result<()> {
    match command {
        SceneCommand::Info { scene } => {
            let scene = crate::args::load_scene(scene)?;
            crate::args::say(format_args!("{} triangles", scene.geometry.len()))
        }
    }
}
