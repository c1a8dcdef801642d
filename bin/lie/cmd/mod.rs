//! One file per subcommand.

pub(crate) mod bench;
pub(crate) mod compare;
pub(crate) mod constructor;
pub(crate) mod inspect;
pub(crate) mod key;
pub(crate) mod render;
pub(crate) mod run;
pub(crate) mod scene;
pub(crate) mod shader;
pub(crate) mod status;
pub(crate) mod view;
mod view_options;
pub(crate) mod walk;
