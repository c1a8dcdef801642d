//! Bottles and glasses, each standing on its origin.

use glam::{Quat, Vec2, Vec3};
use lie_geom::RandomKey;

use super::{Site, model::Model};
use crate::generate::{
    mesh::Mesh,
    shapes::lathe,
    sweep::{profile, smooth, tube, turned},
};

/// A bottle's outline from the middle of its foot to its mouth, as (radius, height) in
/// metres; where its label sits, and from where on it is capped.
struct Outline {
    knots: &'static [[f32; 2]],
    label: [f32; 2],
    cap: f32,
}

const BORDEAUX: Outline = Outline {
    knots: &[
        [0.0, 0.0],
        [0.034, 0.0],
        [0.034, 0.0],
        [0.0372, 0.006],
        [0.0375, 0.09],
        [0.0372, 0.188],
        [0.031, 0.212],
        [0.0165, 0.236],
        [0.0140, 0.262],
        [0.0140, 0.289],
        [0.0140, 0.289],
        [0.0, 0.289],
    ],
    label: [0.06, 0.145],
    cap: 0.25,
};

const BURGUNDY: Outline = Outline {
    knots: &[
        [0.0, 0.0],
        [0.038, 0.0],
        [0.038, 0.0],
        [0.0415, 0.007],
        [0.0418, 0.07],
        [0.0415, 0.135],
        [0.034, 0.182],
        [0.0215, 0.226],
        [0.0150, 0.262],
        [0.0145, 0.298],
        [0.0145, 0.298],
        [0.0, 0.298],
    ],
    label: [0.045, 0.118],
    cap: 0.262,
};

const FLASK: Outline = Outline {
    knots: &[
        [0.0, 0.0],
        [0.043, 0.0],
        [0.043, 0.0],
        [0.0465, 0.008],
        [0.0450, 0.09],
        [0.0480, 0.172],
        [0.0400, 0.196],
        [0.0200, 0.205],
        [0.0165, 0.222],
        [0.0165, 0.252],
        [0.0165, 0.252],
        [0.0, 0.252],
    ],
    label: [0.035, 0.13],
    cap: 0.226,
};

const TALL: Outline = Outline {
    knots: &[
        [0.0, 0.0],
        [0.031, 0.0],
        [0.031, 0.0],
        [0.0340, 0.007],
        [0.0330, 0.12],
        [0.0345, 0.206],
        [0.0270, 0.236],
        [0.0145, 0.262],
        [0.0135, 0.300],
        [0.0165, 0.317],
        [0.0165, 0.317],
        [0.0, 0.317],
    ],
    label: [0.07, 0.17],
    cap: 0.295,
};

const DEMIJOHN: Outline = Outline {
    knots: &[
        [0.0, 0.0],
        [0.036, 0.0],
        [0.036, 0.0],
        [0.052, 0.018],
        [0.0585, 0.06],
        [0.0540, 0.108],
        [0.0330, 0.146],
        [0.0165, 0.170],
        [0.0150, 0.210],
        [0.0190, 0.222],
        [0.0190, 0.222],
        [0.0, 0.222],
    ],
    label: [0.04, 0.07],
    cap: 0.205,
};

const PEAR: Outline = Outline {
    knots: &[
        [0.0, 0.0],
        [0.040, 0.0],
        [0.040, 0.0],
        [0.0470, 0.012],
        [0.0440, 0.06],
        [0.0300, 0.105],
        [0.0390, 0.150],
        [0.0300, 0.196],
        [0.0145, 0.226],
        [0.0150, 0.270],
        [0.0150, 0.270],
        [0.0, 0.270],
    ],
    label: [0.024, 0.05],
    cap: 0.245,
};

const BOTTLES: [&Outline; 6] = [&BORDEAUX, &BURGUNDY, &FLASK, &TALL, &DEMIJOHN, &PEAR];

const WINE_GLASS: &[[f32; 2]] = &[
    [0.0, 0.0],
    [0.034, 0.0],
    [0.034, 0.002],
    [0.012, 0.007],
    [0.0042, 0.02],
    [0.0042, 0.075],
    [0.018, 0.090],
    [0.036, 0.118],
    [0.037, 0.145],
    [0.032, 0.172],
    [0.0312, 0.172],
    [0.0355, 0.145],
    [0.0345, 0.119],
    [0.017, 0.093],
    [0.0, 0.088],
];

const COCKTAIL_GLASS: &[[f32; 2]] = &[
    [0.0, 0.0],
    [0.037, 0.0],
    [0.037, 0.002],
    [0.012, 0.007],
    [0.0042, 0.02],
    [0.0042, 0.09],
    [0.009, 0.098],
    [0.054, 0.146],
    [0.0528, 0.1465],
    [0.008, 0.101],
    [0.0, 0.0985],
];

const TUMBLER: &[[f32; 2]] = &[
    [0.0, 0.0],
    [0.035, 0.0],
    [0.035, 0.0],
    [0.0375, 0.004],
    [0.0395, 0.05],
    [0.0415, 0.092],
    [0.0398, 0.092],
    [0.0378, 0.05],
    [0.0352, 0.012],
    [0.0, 0.010],
];

const HIGHBALL: &[[f32; 2]] = &[
    [0.0, 0.0],
    [0.029, 0.0],
    [0.029, 0.0],
    [0.0315, 0.004],
    [0.0325, 0.075],
    [0.0345, 0.148],
    [0.0330, 0.148],
    [0.0308, 0.075],
    [0.0292, 0.012],
    [0.0, 0.010],
];

/// The kinds of glass.
#[derive(Clone, Copy)]
pub(super) enum Glass {
    Wine,
    Cocktail,
    Tumbler,
    Highball,
}

impl Site {
    /// A bottle; what it is follows from `key`.
    pub(super) fn bottle(&self, key: RandomKey) -> Model {
        let kind = (key.uniform(0) * BOTTLES.len() as f32) as usize % BOTTLES.len();
        let outline = BOTTLES[kind];
        let segments = self.fine(12);
        let size = 0.94 + 0.14 * key.uniform(1);
        let mut profile = profile(outline.knots, self.steps(2));
        profile.iter_mut().for_each(|point| *point *= size);
        let mut model = Model::default();
        let glass = pick(&self.palette.bottles, key.uniform(2));
        model.add(glass, &lathe(&profile, segments), Vec3::ZERO);
        let paper = pick(&self.palette.labels, key.uniform(3));
        let [low, high] = outline.label.map(|height| size * height);
        model.add(
            paper,
            &sleeve(&profile, low, high, 0.0006, segments),
            Vec3::ZERO,
        );
        // A band across the label, in another paper's colour.
        let band = low + (0.25 + 0.4 * key.uniform(4)) * (high - low);
        let paper = pick(&self.palette.labels, (key.uniform(3) + 0.5).fract());
        let width = 0.16 * (high - low);
        let band = sleeve(&profile, band, band + width, 0.0011, segments);
        model.add(paper, &band, Vec3::ZERO);
        let foils = [
            self.palette.gilt,
            self.palette.iron,
            self.palette.oxblood,
            self.palette.cane,
        ];
        let top = profile.iter().map(|point| point.y).fold(0.0, f32::max);
        let mut cap = sleeve(&profile, size * outline.cap, top, 0.0009, segments);
        let mouth = radius_at(&profile, top) + 0.0009;
        let lid = [Vec2::new(mouth, top), Vec2::new(0.8 * mouth, top + 0.004)];
        let lid = [lid[0], lid[1], Vec2::new(0.0, top + 0.004)];
        cap.add(&lathe(&lid, segments), Quat::IDENTITY, Vec3::ZERO);
        model.add(pick(&foils, key.uniform(5)), &cap, Vec3::ZERO);
        model
    }

    /// An empty glass.
    pub(super) fn glass(&self, glass: Glass) -> Mesh {
        let knots = match glass {
            Glass::Wine => WINE_GLASS,
            Glass::Cocktail => COCKTAIL_GLASS,
            Glass::Tumbler => TUMBLER,
            Glass::Highball => HIGHBALL,
        };
        turned(knots, self.steps(1), self.fine(13))
    }

    /// A glass with something in it.
    pub(super) fn drink(&self, glass: Glass, drink: u32) -> Model {
        let (radius, level) = match glass {
            Glass::Wine => (0.0345, 0.128),
            Glass::Cocktail => (0.0450, 0.139),
            Glass::Tumbler => (0.0377, 0.058),
            Glass::Highball => (0.0318, 0.122),
        };
        let mut model = Model::default();
        model.add(self.palette.glass, &self.glass(glass), Vec3::ZERO);
        let surface = [Vec2::new(radius, level), Vec2::new(0.0, level)];
        model.add(drink, &lathe(&surface, self.fine(13)), Vec3::ZERO);
        model
    }

    /// A mug of beer with its head of foam.
    pub(super) fn mug(&self) -> Model {
        let mut model = Model::default();
        let wall = [
            [0.0, 0.0],
            [0.042, 0.0],
            [0.042, 0.0],
            [0.044, 0.004],
            [0.041, 0.022],
            [0.041, 0.128],
        ];
        let segments = self.fine(20);
        let body = turned(&wall, 1, segments);
        model.add(self.palette.beer, &body, Vec3::ZERO);
        let foam = [
            [0.0412, 0.112],
            [0.0425, 0.130],
            [0.0400, 0.146],
            [0.025, 0.155],
            [0.0, 0.157],
        ];
        model.add(
            self.palette.china,
            &turned(&foam, self.steps(2), segments),
            Vec3::ZERO,
        );
        let handle = smooth(
            &[
                Vec3::new(0.038, 0.105, 0.0),
                Vec3::new(0.075, 0.100, 0.0),
                Vec3::new(0.078, 0.045, 0.0),
                Vec3::new(0.038, 0.035, 0.0),
            ],
            self.steps(5),
        );
        let handle = tube(&handle, 0.007, self.fine(8));
        model.add(self.palette.glass, &handle, Vec3::ZERO);
        model
    }
}

pub(super) fn pick(among: &[u32], unit: f32) -> u32 {
    among[(unit * among.len() as f32) as usize % among.len()]
}

/// A profile's radius at a height.
fn radius_at(profile: &[Vec2], height: f32) -> f32 {
    profile
        .windows(2)
        .filter(|pair| pair[0].y <= height && height <= pair[1].y && pair[0].y < pair[1].y)
        .map(|pair| {
            let s = (height - pair[0].y) / (pair[1].y - pair[0].y);
            pair[0].x + s * (pair[1].x - pair[0].x)
        })
        .fold(0.0, f32::max)
}

/// A skin over a profile from one height to another, `thick` metres outside it.
fn sleeve(profile: &[Vec2], low: f32, high: f32, thick: f32, segments: u32) -> Mesh {
    let end = |height| Vec2::new(radius_at(profile, height), height);
    let between = profile
        .iter()
        .copied()
        .filter(|point| point.y > low + 1.0e-4 && point.y < high - 1.0e-4);
    let skin: Vec<Vec2> = std::iter::once(end(low))
        .chain(between)
        .chain([end(high)])
        .map(|point| point + Vec2::new(thick, 0.0))
        .collect();
    lathe(&skin, segments)
}
