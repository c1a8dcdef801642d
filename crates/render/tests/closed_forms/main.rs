//! Light transport against closed forms: inverse squares, polygons by Lambert's formula,
//! furnaces, shadows by similar triangles. Scenes are built here, a few triangles each; a
//! frame of one pixel looks at one point.

#![allow(clippy::unwrap_used)]

mod area_lights;
mod determinism;
mod furnace;
mod partly_hidden;
mod point_lights;
mod reflection;
mod seen;
mod shadows;
mod stage;
mod ward;
