pub mod construct;
pub mod render;
pub mod replica;
