use super::{
    At,
    edge::{Vector, dot, edge_term, subtract},
};

/// The part of closed rows of corners in front of a plane through the origin (Sutherland and
/// Hodgman 1974), corner by corner, so that nothing is kept. Rows need not be convex: what
/// joins their parts runs along the plane both ways, and cancels.
struct Clip {
    normal: Vector,
    first: Option<(Vector, f64)>,
    last: (Vector, f64),
}

impl Clip {
    fn new(normal: Vector) -> Self {
        Self {
            normal,
            first: None,
            last: ([0.0; 3], 0.0),
        }
    }

    /// Takes the next corner, and gives on what is in front.
    fn take(&mut self, corner: Vector, mut give: impl FnMut(Vector)) {
        let here = (corner, dot(self.normal, corner));
        if self.first.is_none() {
            self.first = Some(here);
        } else {
            crossing(self.last, here).map(&mut give);
        }
        if here.1 >= 0.0 {
            give(corner);
        }
        self.last = here;
    }

    /// Closes a row.
    fn close(&mut self, give: impl FnMut(Vector)) {
        if let Some(first) = self.first.take() {
            crossing(self.last, first).map(give);
        }
    }
}

/// Where an edge meets the plane that its ends have these heights above.
fn crossing((a, height_a): (Vector, f64), (b, height_b): (Vector, f64)) -> Option<Vector> {
    let crosses = (height_a >= 0.0) != (height_b >= 0.0);
    let share = height_a / (height_a - height_b);
    let way = subtract(b, a);
    crosses.then(|| [0, 1, 2].map(|axis| a[axis] + share * way[axis]))
}

/// A row of corners, of which the edges are added up.
#[derive(Default)]
struct Row {
    first: Option<(Vector, f64)>,
    last: (Vector, f64),
    sum: f64,
}

impl Row {
    fn take(&mut self, normal: Vector, corner: Vector) {
        let here = (corner, dot(corner, corner).sqrt());
        match self.first {
            Some(_) => self.sum += edge_term(normal, self.last, here),
            None => self.first = Some(here),
        }
        self.last = here;
    }

    fn close(self, normal: Vector) -> f64 {
        let closing = self
            .first
            .map_or(0.0, |first| edge_term(normal, self.last, first));
        self.sum + closing
    }
}

/// Calls `give` with the corners of what a row of corners, seen from a point, has in front of
/// both planes there.
fn clip(corners: &[Vector], at: &At, mut give: impl FnMut(Vector)) {
    let mut shading = Clip::new(at.normal);
    let mut flat = Clip::new(at.geometric_normal);
    for &corner in corners {
        shading.take(subtract(corner, at.position), |corner| {
            flat.take(corner, &mut give);
        });
    }
    shading.close(|corner| flat.take(corner, &mut give));
    flat.close(give);
}

/// Sum of the edge terms of what is in front.
pub(super) fn clipped_terms(corners: &[Vector], at: &At) -> f64 {
    let mut row = Row::default();
    clip(corners, at, |corner| row.take(at.normal, corner));
    row.close(at.normal)
}

/// The same, and the mean of the corners of what is in front, as seen from the point.
pub(super) fn clipped_middle(corners: &[Vector], at: &At) -> (f64, Option<Vector>) {
    let mut row = Row::default();
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    clip(corners, at, |corner| {
        row.take(at.normal, corner);
        sum = [0, 1, 2].map(|axis| sum[axis] + corner[axis]);
        count += 1.0;
    });
    let middle = (count > 0.0).then(|| sum.map(|axis| axis / count));
    (row.close(at.normal), middle)
}
