use lie_scene::Geometry;

/// Which triangles share a vertex.
pub(super) struct Neighbours {
    /// Where each vertex's triangles start in `triangles`, and the end.
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Neighbours {
    /// By the vertices' numbers: meshes that repeat vertices fall apart.
    pub(super) fn new(geometry: &Geometry) -> Self {
        let corners = geometry.triangles();
        let mut starts = vec![0u32; geometry.vertices().len() + 1];
        for &vertex in corners.iter().flatten() {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 1..starts.len() {
            starts[vertex] += starts[vertex - 1];
        }
        let mut next = starts.clone();
        let mut triangles = vec![0; 3 * corners.len()];
        for (triangle, corners) in (0..).zip(corners) {
            for &vertex in corners {
                triangles[next[vertex as usize] as usize] = triangle;
                next[vertex as usize] += 1;
            }
        }
        Self { starts, triangles }
    }

    /// The triangles that share a vertex with this one, it among them, and some more than once; and
    /// those next to it in number, which often share an edge.
    pub(super) fn of(&self, geometry: &Geometry, triangle: u32) -> impl Iterator<Item = u32> {
        let corners = geometry.triangles()[triangle as usize];
        let around = corners.into_iter().flat_map(|vertex| {
            let range = self.starts[vertex as usize]..self.starts[vertex as usize + 1];
            // A pole of a large sphere has hundreds.
            &self.triangles[range.start as usize..range.end.min(range.start + 16) as usize]
        });
        let beside = [triangle.saturating_sub(1), triangle + 1];
        let len = geometry.len() as u32;
        around
            .copied()
            .chain(beside.into_iter().filter(move |&beside| beside < len))
    }
}
