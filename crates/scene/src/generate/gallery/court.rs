//! The sculpture court: plinths, a dais behind a balustrade, a ring of light.

use glam::{Quat, Vec2, Vec3};

use super::{
    COOL, NEUTRAL, Site, WARM,
    walls::{Opening, Room, Wall},
};
use crate::{
    Material,
    generate::{
        mesh::Mesh,
        shapes::{closed_tube, lathe, parametric, rod, sphere, torus, torus_knot},
    },
};

const HEIGHT: f32 = 6.0;
const DAIS_EDGE: f32 = -15.6;
const DAIS_HEIGHT: f32 = 0.45;

impl Site {
    pub(super) fn add_court(&mut self) {
        let room = Room::new([-8.0, 8.0], [-18.0, -8.3], HEIGHT);
        self.add_slabs("court", room, self.palette.tiles);
        self.add_coffers("court", room, [8, 5], 0.35);
        self.add_court_walls();
        self.add_dais();
        self.add_sculptures();
        self.add_ring();
        for (index, (x, z)) in [(-5.0, -11.2), (5.0, -11.2), (-3.0, -15.1), (3.0, -15.1)]
            .into_iter()
            .enumerate()
        {
            let half = Vec3::new(0.7, 0.0, 0.6);
            let corner = Vec3::new(x, HEIGHT - 0.04, z) - half;
            let (edge_u, edge_v) = (2.0 * half.x * Vec3::X, 2.0 * half.z * Vec3::Z);
            self.panel(
                &format!("court panel {index}"),
                corner,
                edge_u,
                edge_v,
                5.5 * NEUTRAL,
            );
        }
        for (index, (x, z)) in [(-8.0, -11.5), (-8.0, -14.4), (8.0, -11.5), (8.0, -14.4)]
            .into_iter()
            .enumerate()
        {
            let normal = -Vec3::X * f32::signum(x);
            self.add_sconce(
                &format!("court sconce {index}"),
                Vec3::new(x, 2.5, z),
                normal,
                5.0 * WARM,
            );
        }
    }

    fn add_court_walls(&mut self) {
        let limestone = self.palette.limestone;
        let wall = |origin, along, through, length| Wall {
            origin,
            along,
            through,
            length,
            height: HEIGHT,
            thickness: 0.3,
        };
        // Shared with the corridor and the galleries, hence as wide as those.
        let south = wall(Vec3::new(-9.3, 0.0, -8.3), Vec3::X, Vec3::Z, 18.6);
        let doors = [
            Opening::door(9.3 - 5.2, 1.5, 2.5),
            Opening::arch(9.3, 2.2, 2.9),
            Opening::door(9.3 + 5.2, 1.5, 2.5),
        ];
        self.add_wall("court south wall", limestone, &south, &doors, [true, false]);
        let north = wall(Vec3::new(-8.3, 0.0, -18.0), Vec3::X, Vec3::NEG_Z, 16.6);
        self.add_wall("court north wall", limestone, &north, &[], [true, false]);
        let west = wall(Vec3::new(-8.0, 0.0, -18.0), Vec3::Z, Vec3::NEG_X, 9.7);
        self.add_wall("court west wall", limestone, &west, &[], [true, false]);
        let east = wall(Vec3::new(8.0, 0.0, -18.0), Vec3::Z, Vec3::X, 9.7);
        self.add_wall("court east wall", limestone, &east, &[], [true, false]);
        let mut cornice = Mesh::default();
        for (wall, span) in [
            (&south, [1.3, 17.3]),
            (&north, [0.3, 16.3]),
            (&west, [0.0, 9.7]),
            (&east, [0.0, 9.7]),
        ] {
            wall.add_cornice(&mut cornice, HEIGHT - 0.35, true, span);
        }
        // Pilasters give the long walls a rhythm.
        for x in [-6.2, -3.1, 3.1, 6.2] {
            cornice.cuboid(
                Vec3::new(x - 0.25, DAIS_HEIGHT, -18.0),
                Vec3::new(x + 0.25, HEIGHT - 0.5, -17.88),
            );
        }
        for z in [-9.6, -13.0] {
            for (min, max) in [(-8.0, -7.88), (7.88, 8.0)] {
                cornice.cuboid(
                    Vec3::new(min, 0.0, z - 0.25),
                    Vec3::new(max, HEIGHT - 0.5, z + 0.25),
                );
            }
        }
        self.part("court cornice", self.palette.trim, cornice);
    }

    /// A raised floor at the far end, with steps in the middle and a balustrade beside them.
    fn add_dais(&mut self) {
        let mut dais = Mesh::default();
        dais.cuboid(
            Vec3::new(-8.0, 0.0, -18.0),
            Vec3::new(8.0, DAIS_HEIGHT, DAIS_EDGE),
        );
        for step in 0..2 {
            let depth = 0.34 * (2 - step) as f32;
            let top = DAIS_HEIGHT * (step + 1) as f32 / 3.0;
            dais.cuboid(
                Vec3::new(-1.7, 0.0, DAIS_EDGE),
                Vec3::new(1.7, top, DAIS_EDGE + depth),
            );
        }
        self.part("dais", self.palette.tiles, dais);

        let profile: Vec<Vec2> = [
            [0.055, 0.0],
            [0.055, 0.06],
            [0.035, 0.08],
            [0.03, 0.12],
            [0.05, 0.2],
            [0.06, 0.28],
            [0.05, 0.36],
            [0.03, 0.46],
            [0.024, 0.56],
            [0.03, 0.62],
            [0.045, 0.64],
            [0.045, 0.7],
        ]
        .map(Vec2::from)
        .to_vec();
        let baluster = lathe(&profile, self.fine(16));
        let z = DAIS_EDGE - 0.15;
        let mut stone = Mesh::default();
        for sign in [-1.0, 1.0] {
            for index in 0..21 {
                let x = sign * (2.12 + 0.275 * index as f32);
                stone.add(
                    &baluster,
                    Quat::IDENTITY,
                    Vec3::new(x, DAIS_HEIGHT + 0.08, z),
                );
            }
            let (from, to) = if sign < 0.0 {
                (-7.95, -1.7)
            } else {
                (1.7, 7.95)
            };
            let rail = |stone: &mut Mesh, bottom: f32, top: f32, half: f32| {
                stone.cuboid(
                    Vec3::new(from, DAIS_HEIGHT + bottom, z - half),
                    Vec3::new(to, DAIS_HEIGHT + top, z + half),
                );
            };
            rail(&mut stone, 0.0, 0.08, 0.09);
            rail(&mut stone, 0.78, 0.88, 0.10);
            let post = sign * 1.83;
            stone.cuboid(
                Vec3::new(post - 0.14, DAIS_HEIGHT, z - 0.14),
                Vec3::new(post + 0.14, DAIS_HEIGHT + 0.98, z + 0.14),
            );
            let top = Vec3::new(post, DAIS_HEIGHT + 1.13, z);
            self.add_globe(&format!("newel globe {sign}"), top, 0.14, 7.0 * WARM);
        }
        self.part("balustrade", self.palette.limestone, stone);
        // Low lamps behind it: the balusters' shadows fan out over the court's floor.
        for (index, x) in [-4.9, 4.9].into_iter().enumerate() {
            let lamp = Vec3::new(x, DAIS_HEIGHT + 1.15, -17.3);
            let stem = Vec3::new(x, DAIS_HEIGHT, -17.5);
            let target = Vec3::new(0.72 * x, 0.0, -12.4);
            self.add_spot(
                &format!("dais spot {index}"),
                lamp,
                target,
                60.0 * WARM,
                [26.0, 46.0],
                stem,
            );
        }
    }

    fn add_plinth(&mut self, name: &str, foot: Vec3, half: f32, height: f32) -> Vec3 {
        let mut mesh = Mesh::default();
        let slab = |mesh: &mut Mesh, half: f32, bottom: f32, top: f32| {
            mesh.cuboid(
                foot + Vec3::new(-half, bottom, -half),
                foot + Vec3::new(half, top, half),
            );
        };
        slab(&mut mesh, half + 0.06, 0.0, 0.12);
        slab(&mut mesh, half, 0.12, height - 0.06);
        slab(&mut mesh, half + 0.04, height - 0.06, height);
        self.part(format!("{name} plinth"), self.palette.limestone, mesh);
        foot + height * Vec3::Y
    }

    fn add_sculptures(&mut self) {
        let (marble, bronze, black) =
            (self.palette.marble, self.palette.bronze, self.palette.black);
        let counts = [self.fine(320), self.fine(28)];
        // The middle: a trefoil knot, upright.
        let foot = Vec3::new(0.0, 0.0, -12.6);
        let top = self.add_plinth("trefoil", foot, 0.55, 0.8);
        let mut knot = Mesh::default();
        let upright = Quat::from_rotation_x(std::f32::consts::FRAC_PI_2);
        knot.add(
            &torus_knot(2.0, 3.0, 0.62, 0.135, counts),
            upright,
            top + 1.05 * Vec3::Y,
        );
        self.part("trefoil", bronze, knot);

        let top = self.add_plinth("cinquefoil", Vec3::new(-4.8, 0.0, -13.6), 0.4, 0.95);
        let mut knot = Mesh::default();
        knot.add(
            &torus_knot(2.0, 5.0, 0.42, 0.075, counts),
            upright,
            top + 0.72 * Vec3::Y,
        );
        self.part("cinquefoil", marble, knot);

        let top = self.add_plinth("figure", Vec3::new(4.8, 0.0, -13.6), 0.4, 0.95);
        let figure = self.twisted_figure();
        self.put("figure", marble, &figure, top);

        let top = self.add_plinth("nest", Vec3::new(-6.3, 0.0, -9.9), 0.36, 1.0);
        let mut rings = Mesh::default();
        for index in 0..4 {
            let radius = 0.36 - 0.07 * index as f32;
            let turn = Quat::from_euler(
                glam::EulerRot::YXZ,
                0.7 * index as f32,
                1.25 - 0.2 * index as f32,
                0.3,
            );
            rings.add(
                &torus(radius, 0.03, [self.fine(64), self.fine(14)]),
                turn,
                top + 0.42 * Vec3::Y,
            );
        }
        rings.add(
            &sphere(0.09, self.fine(28)),
            Quat::IDENTITY,
            top + 0.42 * Vec3::Y,
        );
        self.part("nest", self.palette.brass, rings);

        let top = self.add_plinth("loop", Vec3::new(6.3, 0.0, -9.9), 0.36, 1.0);
        let ribbon = closed_tube(counts, 0.055, |t| {
            let a = t * std::f32::consts::TAU;
            Vec3::new(
                0.34 * a.cos() + 0.1 * (3.0 * a).cos(),
                0.30 * (2.0 * a).sin(),
                0.34 * a.sin(),
            )
        });
        self.put("loop", black, &ribbon, top + 0.43 * Vec3::Y);
        self.add_sculpture_spots();
    }

    /// A turned shape that bends and twists as it rises.
    fn twisted_figure(&self) -> Mesh {
        parametric([self.fine(72), self.fine(96)], |u, v| {
            let angle = u * std::f32::consts::TAU;
            let profile = 0.20 + 0.07 * (v * 9.0).sin() * (1.0 - v) - 0.11 * v * v;
            let lobes = 1.0 + 0.22 * (3.0 * angle + 5.0 * v).cos() * (1.0 - 0.5 * v);
            let radius = (profile * lobes).max(0.012)
                * (1.0 - ((v - 0.94) / 0.06).clamp(0.0, 1.0).powi(2))
                    .max(0.0)
                    .sqrt();
            let lean = 0.09 * (v * 5.0).sin();
            Vec3::new(radius * angle.cos() + lean, 1.25 * v, -radius * angle.sin())
        })
    }

    /// A key and a fill on each sculpture, from two sides and in two colours.
    fn add_sculpture_spots(&mut self) {
        let stem = |lamp: Vec3| Vec3::new(lamp.x, HEIGHT - 0.1, lamp.z);
        for (index, (x, y, z)) in [
            (0.0, 1.8, -12.6),
            (-4.8, 1.6, -13.6),
            (4.8, 1.6, -13.6),
            (-6.3, 1.4, -9.9),
            (6.3, 1.4, -9.9),
        ]
        .into_iter()
        .enumerate()
        {
            let target = Vec3::new(x, y, z);
            // Towards the middle of the room, and over the visitor's shoulder.
            let away = if x == 0.0 { 1.0 } else { -f32::signum(x) };
            let key = target + Vec3::new(1.7 * away, 4.9 - y, 1.3);
            let fill = target + Vec3::new(-1.1 * away, 4.9 - y, -1.4);
            let strength = if x == 0.0 { 1.35 } else { 1.0 };
            let name = format!("sculpture key {index}");
            self.add_spot(
                &name,
                key,
                target,
                75.0 * strength * NEUTRAL,
                [9.0, 17.0],
                stem(key),
            );
            let name = format!("sculpture fill {index}");
            self.add_spot(
                &name,
                fill,
                target,
                18.0 * strength * COOL,
                [12.0, 22.0],
                stem(fill),
            );
        }
    }

    /// A glowing ring over the middle, on three wires: one light of many triangles.
    fn add_ring(&mut self) {
        let center = Vec3::new(0.0, 4.35, -12.6);
        let material = self.draft.add_material(Material {
            emission: 12.0 * NEUTRAL,
            ..Material::diffuse("ring of light", Vec3::splat(0.8))
        });
        let ring = torus(1.25, 0.05, [self.fine(72), self.fine(10)]);
        self.put("ring of light", material, &ring, center);
        let mut wires = Mesh::default();
        for wire in 0..3 {
            let (sin, cos) = (wire as f32 / 3.0 * std::f32::consts::TAU).sin_cos();
            let foot = center + Vec3::new(1.25 * cos, 0.055, 1.25 * sin);
            let top = Vec3::new(center.x + 0.3 * cos, HEIGHT, center.z + 0.3 * sin);
            wires.add(&rod(foot, top, 0.006, 6), Quat::IDENTITY, Vec3::ZERO);
        }
        self.part("ring wires", self.palette.black, wires);
    }
}
