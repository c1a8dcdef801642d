//! What [`super::inspect`] finds, as plain data. The names of fields are those in JSON and stay.
//!
//! Positions and distances are in metres, in world space. Radiances are linear Rec. 709, towards
//! the eye, in W·sr⁻¹·m⁻²; luminances are of these.

use serde::Serialize;

/// One pixel of a view.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PixelReport {
    /// Name of the camera.
    pub camera: String,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// Column and row; row 0 is on top.
    pub pixel: [u32; 2],
    /// Samples of the whole tree.
    pub samples: u64,
    /// Version of the tree.
    pub version: u64,
    /// Samples that must agree on a light that gives all of a pixel's light.
    pub trust: u32,
    /// What is there; `None` if nothing is.
    pub seen: Option<SeenReport>,
}

/// A pixel that shows a surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SeenReport {
    /// What the camera sees.
    pub surface: SurfaceReport,
    /// The smallest cell around it.
    pub cell: CellReport,
    /// All lights of the scene, in order of their number.
    pub lights: Vec<LightReport>,
    /// Sums over all lights.
    pub totals: TotalsReport,
}

/// What the camera sees.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceReport {
    /// Place.
    pub position: [f32; 3],
    /// Where its shadow rays start, which decides about its cell.
    pub shadow_origin: [f32; 3],
    /// Shading normal, on the side of the eye.
    pub normal: [f32; 3],
    /// Distance from the eye.
    pub distance: f32,
    /// Number of the triangle.
    pub triangle: u32,
    /// Name of its mesh.
    pub mesh: String,
    /// Name of its material.
    pub material: String,
    /// Radiance that it emits itself; in no total.
    pub emitted: [f32; 3],
}

/// A cell of the octree.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellReport {
    /// The octant taken at each level, from the root down; bit 0 is x, bit 1 y, bit 2 z.
    pub path: Vec<usize>,
    /// Levels below the root.
    pub depth: u32,
    /// Its box.
    pub bounds: BoundsReport,
    /// What its LIE is about; `None` if it was never sampled.
    pub region: Option<BoundsReport>,
    /// Whether the LIE holds for the point: elsewhere every light is traced. Always so with
    /// trust 0.
    pub holds: bool,
    /// Samples taken in it.
    pub samples: u32,
    /// Samples that speak for lights without evidence.
    pub dark_samples: u32,
    /// Occluders in all of its lists.
    pub occluders: usize,
}

/// A box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BoundsReport {
    /// Smallest corner.
    pub min: [f32; 3],
    /// Largest corner.
    pub max: [f32; 3],
}

/// What is known of a light in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LightClass {
    /// Geometry: nothing is in the way.
    ProvenUnoccluded,
    /// Geometry: nothing but a list of triangles can be in the way.
    CompleteList,
    /// Geometry: it does not reach the region.
    ProvenHidden,
    /// Samples: it reaches the cell, past its occluders if it has any.
    Lit,
    /// Samples: it does not reach the cell.
    Hidden,
    /// No sample could have had anything of it.
    Dark,
    /// Others outshine it: it is left out.
    MaskedOut,
    /// Others outshine it: its shadows are left out.
    MaskedWhole,
    /// Too much is in the way to list.
    Crowded,
    /// Too little is known.
    Doubtful,
}

/// How shaders find a light's contribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Answer {
    /// Without a ray.
    Unoccluded,
    /// By rays against its occluders.
    List,
    /// By rays through the scene.
    Traced,
    /// It is left out.
    Hidden,
}

/// One light at the point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LightReport {
    /// Number of the light.
    pub light: u32,
    /// Its name.
    pub name: String,
    /// point, spot, directional or area.
    pub kind: &'static str,
    /// What is known of it in the cell, whether or not the LIE holds for the point.
    pub class: LightClass,
    /// Whether geometry was asked in vain: four times as many samples must agree.
    pub open: bool,
    /// How shaders find its contribution here.
    pub answer: Answer,
    /// Rays behind what is known, of lights that samples tell of.
    pub evidence: Option<EvidenceReport>,
    /// Rays that must agree before shaders rely on it.
    pub needed: u32,
    /// Radiance that it gives.
    pub exact: [f32; 3],
    /// Radiance that shaders show of it.
    pub shaded: [f32; 3],
    /// Luminance of `exact`.
    pub luminance: f32,
    /// Luminance of `shaded` less that of `exact`: above 0 is too bright.
    pub error: f32,
    /// Root mean square of the error to be expected, as luminance.
    pub expected_error: f64,
    /// Shadow rays of the standard ray tracer.
    pub standard_rays: u32,
    /// Those that are cast.
    pub traced_rays: u32,
    /// Those that are not.
    pub saved_rays: u32,
    /// Rays tested against its occluders instead.
    pub list_rays: u32,
    /// Triangles that these rays are tested against; all of the list counts for each.
    pub occluder_tests: u64,
    /// Triangles known to come in between; of a hidden light, some.
    pub occluders: Vec<OccluderReport>,
    /// Triangles that block rays which shaders let through.
    pub missed: Vec<TriangleReport>,
}

/// What rays from a cell to a light met. Of rays from one point that met the same, two count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct EvidenceReport {
    /// Rays that reached it.
    pub clear: u16,
    /// Rays that did not.
    pub blocked: u16,
    /// Rays that agreed with what was known, since one last added to it.
    pub agreed: u16,
    /// Whether it is known to reach the cell from the one that this was split from alone.
    pub inherited: bool,
}

/// A triangle by its names.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct TriangleReport {
    /// Its number.
    pub triangle: u32,
    /// Name of its mesh.
    pub mesh: String,
    /// Name of its material.
    pub material: String,
}

/// A triangle in a light's list.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct OccluderReport {
    /// Which triangle.
    #[serde(flatten)]
    pub triangle: TriangleReport,
    /// Whether it was seen to block a ray from this very cell; else it may, by geometry or by
    /// what the cell inherited.
    pub confirmed: bool,
}

/// Sums over all lights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TotalsReport {
    /// Radiance that the lights give.
    pub exact: [f32; 3],
    /// Radiance that shaders show.
    pub shaded: [f32; 3],
    /// Luminance of `exact`.
    pub luminance: f32,
    /// Luminance of `shaded` less that of `exact`.
    pub error: f32,
    /// Root mean square of the error to be expected, as luminance.
    pub expected_error: f64,
    /// Shadow rays of the standard ray tracer.
    pub standard_rays: u64,
    /// Those that are cast.
    pub traced_rays: u64,
    /// Those that are not.
    pub saved_rays: u64,
    /// Rays tested against occluders instead.
    pub list_rays: u64,
    /// Triangles that these rays are tested against.
    pub occluder_tests: u64,
}
