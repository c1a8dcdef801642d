use super::LoadError;
use crate::Scene;
use std::path::Path;
pub(super) fn load(path: &Path) -> Result<(Scene, Vec<String>), LoadError> {
    Err(LoadError::UnknownFormat {
        path: path.to_owned(),
    })
}
