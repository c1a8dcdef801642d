use glam::{UVec2, Vec2};
use lie_geom::{RandomKey, Ray};
use lie_octree::{LieSettings, Observation};
use lie_scene::Camera;

use super::ConstructSettings;

/// What somebody looks at: samples are taken where it shows the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// From where.
    pub camera: Camera,
    /// Columns and rows of the picture.
    pub size: UVec2,
}

/// How far one view has come.
pub(super) struct ViewProgress {
    pub(super) view: View,
    pub(super) epoch: u64,
    key: RandomKey,
    /// The picture's squares, neighbours close to each other.
    pub(super) squares: Vec<UVec2>,
    /// Squares sampled so far, over all passes.
    pub(super) taken: u64,
    pass: Pass,
    /// The last two whole passes through the pixels' centres, the later one first.
    pub(super) last: [Option<Finding>; 2],
    pub(super) typical: f32,
}

/// What a whole pass showed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Finding {
    /// Relative RMSE of the picture.
    pub(crate) error: f32,
    /// Share of the light evaluations that are in doubt, and traced for that.
    pub(crate) doubtful: f32,
}

/// Share of a view's light evaluations that may be in doubt when it counts as converged; and
/// which less must have come out of doubt by two passes for the rest to be left as it is.
const DOUBTFUL: f32 = 0.01;

/// A part of one pass over a view: up to 16 × 16 pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Square {
    /// Its first pixel.
    origin: UVec2,
    /// Columns and rows.
    size: UVec2,
    pub(super) pass: u64,
}

impl Square {
    pub(super) const SIDE: u32 = 16;

    pub(super) fn pixels(&self) -> u64 {
        u64::from(self.size.x) * u64::from(self.size.y)
    }

    /// Its pixels, in blocks of up to 4 × 4.
    pub(super) fn blocks(self) -> impl Iterator<Item = impl Iterator<Item = UVec2>> {
        let starts = grid(self.size.map(|side| side.div_ceil(4))).map(|block| 4 * block);
        starts.map(move |start| {
            let size = (self.size - start).min(UVec2::splat(4));
            grid(size).map(move |offset| self.origin + start + offset)
        })
    }
}

fn grid(size: UVec2) -> impl Iterator<Item = UVec2> {
    (0..size.y).flat_map(move |y| (0..size.x).map(move |x| UVec2::new(x, y)))
}

/// Whether a pass looks where a frame with one sample per pixel does.
fn goes_through_centres(pass: u64) -> bool {
    pass.is_multiple_of(2)
}

/// What one pass showed: one sample in every pixel.
#[derive(Default)]
struct Pass {
    pixels: u64,
    evaluations: u64,
    trusted: u64,
    /// For each surface point, the luminance that LIEs answer for: as the tree had it, and
    /// as it is.
    luminances: Vec<(f32, f32)>,
}

impl ViewProgress {
    /// A view that nobody has looked at yet. Of views that are sampled twice, each in its own
    /// epoch, the samples are different ones.
    pub(super) fn new(view: View, seed: u64, epoch: u64) -> Self {
        let counts = view.size.map(|side| side.div_ceil(Square::SIDE));
        let mut squares: Vec<UVec2> = grid(counts).collect();
        squares.sort_by_key(|square| interleaved(square.x) | interleaved(square.y) << 1);
        let key = RandomKey::new(seed).mix(CONSTRUCTION);
        Self {
            view,
            epoch,
            key: if epoch == 0 { key } else { key.mix(epoch) },
            squares,
            taken: 0,
            pass: Pass::default(),
            typical: 0.0,
            last: [None; 2],
        }
    }

    /// The next square of the picture.
    pub(super) fn next_square(&mut self) -> Square {
        let count = self.squares.len() as u64;
        let (pass, index) = (self.taken / count, self.taken % count);
        self.taken += 1;
        let origin = self.squares[index as usize] * Square::SIDE;
        Square {
            origin,
            size: (self.view.size - origin).min(UVec2::splat(Square::SIDE)),
            pass,
        }
    }

    /// The camera ray of a pixel, and the key of its random numbers. The first pass and every
    /// other go through the pixels' centres, where a frame with one sample per pixel looks:
    /// what only a single pixel shows is found as well. The passes between go through random
    /// places.
    pub(super) fn camera_ray(&self, pixel: UVec2, pass: u64) -> (Ray, RandomKey) {
        let key = self
            .key
            .mix(pass)
            .mix(u64::from(pixel.x) | u64::from(pixel.y) << 32);
        let offset = if goes_through_centres(pass) {
            Vec2::splat(0.5)
        } else {
            key.uniform2(0)
        };
        let film = pixel.as_vec2() + offset;
        (self.view.camera.ray(film, self.view.size), key.mix(1))
    }

    /// What is random of a square but not of its pixels.
    pub(super) fn random(&self, square: Square) -> RandomKey {
        let key = self.key.mix(square.pass).mix(u64::MAX);
        key.mix(u64::from(square.origin.x) | u64::from(square.origin.y) << 32)
    }

    /// Mean luminance of the last whole pass, or of what there is of the first, without the
    /// brightest.
    pub(super) fn typical(&self) -> f32 {
        self.typical
    }

    /// Relative RMSE of the picture, as the last whole pass through the pixels' centres showed
    /// it.
    pub(super) fn error(&self) -> Option<f32> {
        self.last[0].map(|last| last.error)
    }

    /// Whether more construction would make the picture neither better nor much cheaper. What
    /// is traced is right: of doubt it matters alone whether there will be less of it soon.
    pub(super) fn has_converged(&self, settings: &ConstructSettings) -> bool {
        let [Some(last), before] = self.last else {
            return false;
        };
        let LieSettings {
            trust,
            split_samples,
            ..
        } = settings.lie;
        let gained = before.map(|before| Finding {
            error: before.error - last.error,
            doubtful: before.doubtful - last.doubtful,
        });
        // With doubt an error is what samples in a row did not show, and stays.
        let is_right = last.error <= settings.tolerance
            || trust > 0 && gained.is_some_and(|gained| gained.error < settings.tolerance);
        // Two rays to each light from every sample: no cell can be known earlier.
        let patience = u64::from(trust / (2 * split_samples.max(1)));
        let is_cheap = last.doubtful <= DOUBTFUL
            || self.passes() >= patience.max(3)
                && gained.is_some_and(|gained| gained.doubtful < DOUBTFUL);
        is_right && is_cheap
    }

    /// Whole passes so far.
    fn passes(&self) -> u64 {
        self.taken / self.squares.len() as u64
    }

    /// Takes in what a square showed.
    pub(super) fn count(&mut self, square: Square, observations: &[Observation]) {
        let pass = &mut self.pass;
        pass.pixels += square.pixels();
        for seen in observations {
            pass.evaluations += u64::from(seen.evaluations);
            pass.trusted += u64::from(seen.trusted);
            pass.luminances.push((seen.predicted, seen.actual));
        }
        let is_whole = pass.pixels == u64::from(self.view.size.x) * u64::from(self.view.size.y);
        if is_whole {
            let pass = std::mem::take(&mut self.pass);
            self.typical = pass.mean();
            if goes_through_centres(square.pass) {
                let found = Finding {
                    error: pass.relative_rmse(),
                    doubtful: 1.0 - pass.trusted_share(),
                };
                self.last = [Some(found), self.last[0]];
            }
        }
    }

    /// Ends a batch: the first pass has no other to know the picture's luminance from.
    pub(super) fn end_batch(&mut self) {
        if self.last[0].is_none() && self.pass.pixels > 0 {
            self.typical = self.pass.mean();
        }
    }
}

/// Keeps construction's random numbers apart from the frames'.
const CONSTRUCTION: u64 = 0x6c69_6573;

/// A number's bits, with a zero between each two.
fn interleaved(number: u32) -> u64 {
    (0..32).fold(0, |bits, bit| {
        bits | u64::from(number >> bit & 1) << (2 * bit)
    })
}

impl Pass {
    /// The luminance that a thousandth of the points exceed. Surfaces centimetres from a
    /// lamp would outweigh the whole picture: they count as no more than this.
    fn white(&self) -> f32 {
        let mut actual: Vec<f32> = self.luminances.iter().map(|&(_, actual)| actual).collect();
        let rank = actual.len() * 999 / 1000;
        match actual.get(rank) {
            Some(_) => *actual.select_nth_unstable_by(rank, f32::total_cmp).1,
            None => 0.0,
        }
    }

    /// Mean over all pixels.
    fn mean(&self) -> f32 {
        let white = self.white();
        let shown = self
            .luminances
            .iter()
            .map(|&(_, actual)| f64::from(actual.min(white)));
        (shown.sum::<f64>() / self.pixels as f64) as f32
    }

    fn relative_rmse(&self) -> f32 {
        let white = self.white();
        let squared = |&(predicted, actual): &(f32, f32)| {
            f64::from(predicted.min(white) - actual.min(white)).powi(2)
        };
        let sum: f64 = self.luminances.iter().map(squared).sum();
        let rmse = (sum / self.pixels as f64).sqrt() as f32;
        if rmse == 0.0 { 0.0 } else { rmse / self.mean() }
    }

    fn trusted_share(&self) -> f32 {
        if self.evaluations == 0 {
            1.0
        } else {
            self.trusted as f32 / self.evaluations as f32
        }
    }
}
