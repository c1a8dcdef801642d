//! Plots, as SVG. No fonts are needed to draw them.

use std::ops::Range;

use plotters::{coord::Shift, prelude::*};

use crate::BenchError;

/// Bars that stand together.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// What is written below.
    pub name: String,
    /// What each bar is of, and its height. Bars of the same name have one colour.
    pub bars: Vec<(String, f64)>,
}

/// A line through points.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// For the legend.
    pub name: String,
    /// Points from left to right.
    pub points: Vec<(f64, f64)>,
}

/// The axes of some curves.
#[derive(Clone, Debug, PartialEq)]
pub struct Axes<'a> {
    /// Over the plot.
    pub title: &'a str,
    /// What is to the right; logarithmic.
    pub x: &'a str,
    /// What is upwards; logarithmic.
    pub y: &'a str,
    /// Smaller values are drawn at this one: a logarithm has no zero.
    pub floor: f64,
}

/// What bars leave free above them, for the legend.
const HEADROOM: f64 = 1.4;

/// Pixels of a plot.
const SIZE: (u32, u32) = (720, 420);

/// Colours that people with any eyes can tell apart (Okabe and Ito 2008).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(230, 159, 0),
    RGBColor(0, 158, 115),
    RGBColor(213, 94, 0),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
];

/// Curves that are drawn without gaps; those after them are dashed.
const SOLID: usize = 2;

/// Groups of bars side by side; `None` if there is nothing to show.
///
/// # Errors
/// If the plot cannot be drawn.
pub fn bars(title: &str, axis: &str, groups: &[Group]) -> Result<Option<String>, BenchError> {
    let all = || groups.iter().flat_map(|group| &group.bars);
    let top = all()
        .map(|&(_, value)| value)
        .filter(|value| value.is_finite());
    let top = top.fold(0.0, f64::max);
    let mut names: Vec<&str> = vec![];
    for (name, _) in all() {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    if top <= 0.0 {
        return Ok(None);
    }
    draw(|area| draw_bars(area, (title, axis), groups, &names, HEADROOM * top)).map(Some)
}

/// Curves over logarithmic axes; `None` if there is nothing to show. Points that are not
/// right of zero are left out.
///
/// # Errors
/// If the plot cannot be drawn.
pub fn curves(axes: &Axes<'_>, curves: &[Curve]) -> Result<Option<String>, BenchError> {
    let visible = |&(x, y): &(f64, f64)| x > 0.0 && x.is_finite() && y.is_finite();
    let curves: Vec<Curve> = curves
        .iter()
        .map(|curve| Curve {
            name: curve.name.clone(),
            points: curve
                .points
                .iter()
                .filter(|point| visible(point))
                .map(|&(x, y)| (x, y.max(axes.floor)))
                .collect(),
        })
        .collect();
    let points = || curves.iter().flat_map(|curve| &curve.points);
    if points().next().is_none() {
        return Ok(None);
    }
    let x_range = decades(points().map(|&(x, _)| x));
    let y_range = decades(points().map(|&(_, y)| y));
    draw(|area| {
        let mut chart = ChartBuilder::on(area)
            .caption(axes.title, ("sans-serif", 18))
            .margin(12)
            .x_label_area_size(42)
            .y_label_area_size(72)
            .build_cartesian_2d(x_range.clone().log_scale(), y_range.clone().log_scale())
            .map_err(failed)?;
        chart
            .configure_mesh()
            .x_desc(axes.x)
            .y_desc(axes.y)
            .x_label_formatter(&|&value| short(value))
            .y_label_formatter(&|&value| short(value))
            .max_light_lines(0)
            .bold_line_style(BLACK.mix(0.12))
            .draw()
            .map_err(failed)?;
        for (index, curve) in curves.iter().enumerate() {
            let color = COLORS[index % COLORS.len()];
            let points = curve.points.iter().copied();
            let style = color.stroke_width(2);
            let legend =
                move |(x, y)| Rectangle::new([(x, y - 5), (x + 12, y + 5)], color.filled());
            let drawn = if index < SOLID {
                let line = LineSeries::new(points.clone(), style);
                chart.draw_series(line).map_err(failed)?
            } else {
                // Each with gaps of its own, so that what is below it shows.
                let gap = 2 + 2 * (index - SOLID) as u32;
                let line = DashedLineSeries::new(points.clone(), 6, gap, style);
                chart.draw_series(line).map_err(failed)?
            };
            drawn.label(&curve.name).legend(legend);
            let dots = points.map(|point| Circle::new(point, 3, color.filled()));
            chart.draw_series(dots).map_err(failed)?;
        }
        let corner = Corner::clearest(&curves, &x_range, &y_range);
        draw_legend(&mut chart, corner)
    })
    .map(Some)
}

/// Where a legend stands: right or left, and at the top or the bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Corner {
    is_right: bool,
    is_top: bool,
}

impl Corner {
    const TOP_RIGHT: Self = Self {
        is_right: true,
        is_top: true,
    };

    /// The corner where a legend of these curves hides least of them; at the top right, if that is as good
    /// as others.
    fn clearest(curves: &[Curve], x_range: &Range<f64>, y_range: &Range<f64>) -> Self {
        let share = |value: f64, range: &Range<f64>| {
            (value / range.start).log10() / (range.end / range.start).log10()
        };
        let place = |&(x, y): &(f64, f64)| [share(x, x_range), share(y, y_range)];
        let places = |curve: &Curve| curve.points.iter().map(place).collect::<Vec<_>>();
        let drawn: Vec<[f64; 2]> = curves.iter().flat_map(|it| along(&places(it))).collect();
        let corners = [(true, true), (false, true), (true, false), (false, false)];
        let corners = corners.map(|(is_right, is_top)| Self { is_right, is_top });
        let hides = |corner: &Self| drawn.iter().filter(|&&at| corner.hides(at)).count();
        corners
            .into_iter()
            .min_by_key(hides)
            .unwrap_or(Self::TOP_RIGHT)
    }

    /// Whether the legend stands before a place, in shares of the plot's width and height.
    fn hides(self, [x, y]: [f64; 2]) -> bool {
        /// About what names and their colours take.
        const SIZE: [f64; 2] = [0.4, 0.3];
        let across = if self.is_right { 1.0 - x } else { x };
        let down = if self.is_top { 1.0 - y } else { y };
        across < SIZE[0] && down < SIZE[1]
    }

    fn position(self) -> SeriesLabelPosition {
        match (self.is_right, self.is_top) {
            (true, true) => SeriesLabelPosition::UpperRight,
            (false, true) => SeriesLabelPosition::UpperLeft,
            (true, false) => SeriesLabelPosition::LowerRight,
            (false, false) => SeriesLabelPosition::LowerLeft,
        }
    }
}

/// Places along a curve: its own, and some on the lines between them.
fn along(places: &[[f64; 2]]) -> Vec<[f64; 2]> {
    const STEPS: usize = 16;
    let between = |pair: &[[f64; 2]]| {
        let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
        (0..STEPS).map(move |step| {
            let share = step as f64 / STEPS as f64;
            [x0 + share * (x1 - x0), y0 + share * (y1 - y0)]
        })
    };
    let lines = places.windows(2).flat_map(between);
    lines.chain(places.iter().copied()).collect()
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// An SVG that is drawn on white.
fn draw(paint: impl FnOnce(&Area<'_>) -> Result<(), BenchError>) -> Result<String, BenchError> {
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, SIZE).into_drawing_area();
        area.fill(&WHITE).map_err(failed)?;
        paint(&area)?;
        area.present().map_err(failed)?;
    }
    Ok(svg)
}

fn draw_bars(
    area: &Area<'_>,
    (title, axis): (&str, &str),
    groups: &[Group],
    names: &[&str],
    top: f64,
) -> Result<(), BenchError> {
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(34)
        .y_label_area_size(72)
        .build_cartesian_2d(0.0..groups.len() as f64, 0.0..top)
        .map_err(failed)?;
    // A label in the middle of each group: the mesh puts them at halves, of which every
    // second is a boundary.
    let label = |&x: &f64| {
        let group = groups.get(x.floor() as usize);
        let is_middle = (x.fract() - 0.5).abs() < 1.0e-6;
        group
            .filter(|_| is_middle)
            .map_or(String::new(), |group| group.name.clone())
    };
    chart
        .configure_mesh()
        .disable_x_mesh()
        .x_labels(2 * groups.len() + 1)
        .x_label_formatter(&label)
        .y_desc(axis)
        .max_light_lines(0)
        .bold_line_style(BLACK.mix(0.12))
        .draw()
        .map_err(failed)?;
    let width = 0.8 / names.len() as f64;
    for (series, name) in names.iter().enumerate() {
        let color = COLORS[series % COLORS.len()];
        let bars = groups.iter().enumerate().flat_map(|(index, group)| {
            let left = index as f64 + 0.1 + series as f64 * width;
            let own = group
                .bars
                .iter()
                .filter(|(own, height)| own == name && height.is_finite());
            own.map(move |&(_, height)| {
                Rectangle::new([(left, 0.0), (left + 0.92 * width, height)], color.filled())
            })
        });
        chart
            .draw_series(bars)
            .map_err(failed)?
            .label(*name)
            .legend(move |(x, y)| Rectangle::new([(x, y - 5), (x + 12, y + 5)], color.filled()));
    }
    draw_legend(&mut chart, Corner::TOP_RIGHT)
}

fn draw_legend<'a, X, Y>(
    chart: &mut ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>,
    corner: Corner,
) -> Result<(), BenchError>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    chart
        .configure_series_labels()
        .position(corner.position())
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .draw()
        .map_err(failed)
}

/// The range of some values, widened to whole decades so that it is never empty, and a hair
/// more: a decade that is the edge itself may lose its label to rounding.
fn decades(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (min, max) = values.fold((f64::MAX, f64::MIN_POSITIVE), |(min, max), value| {
        (min.min(value), max.max(value))
    });
    let (low, high) = (min.log10().floor(), max.log10().ceil());
    0.999 * 10f64.powf(low)..1.001 * 10f64.powf(high.max(low + 1.0))
}

fn short(value: f64) -> String {
    match value {
        v if !(1.0e-4..1.0e6).contains(&v) => format!("{v:.0e}"),
        v => format!("{v}"),
    }
}

fn failed(error: impl std::fmt::Display) -> BenchError {
    BenchError::Plot(error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    const AXES: Axes<'_> = Axes {
        title: "error",
        x: "seconds",
        y: "relative RMSE",
        floor: 1.0e-6,
    };

    fn curve(points: &[(f64, f64)]) -> Curve {
        Curve {
            name: "trust".to_owned(),
            points: points.to_vec(),
        }
    }

    #[test]
    fn curves_are_drawn_with_what_a_logarithm_can_show() {
        let points = [(0.0, 1.0), (1.0, 0.5), (2.0, 0.0), (4.0, f64::INFINITY)];
        let svg = curves(&AXES, &[curve(&points)]).unwrap().unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for text in ["error", "seconds", "relative RMSE", "trust"] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert_eq!(curves(&AXES, &[curve(&points[..1])]).unwrap(), None);
        assert_eq!(curves(&AXES, &[]).unwrap(), None);
        assert!(curves(&AXES, &[curve(&[(1.0, 1.0)])]).unwrap().is_some());
    }

    #[test]
    fn a_legend_stands_where_no_curve_runs() {
        let corner = |curves: &[Curve]| Corner::clearest(curves, &(1.0..1000.0), &(1.0..1000.0));
        let along_the_top = curve(&[(1.0, 990.0), (990.0, 500.0)]);
        let rising = curve(&[(1.0, 1.0), (990.0, 990.0)]);
        let falling = curve(&[(1.0, 990.0), (990.0, 1.0)]);
        let is_bottom_right = Corner {
            is_right: true,
            is_top: false,
        };
        assert_eq!(corner(std::slice::from_ref(&falling)), Corner::TOP_RIGHT);
        assert_eq!(
            corner(std::slice::from_ref(&along_the_top)),
            is_bottom_right
        );
        assert_eq!(corner(&[along_the_top, rising]), is_bottom_right);
        // Of a line between two far places as well.
        assert!(!corner(&[falling]).hides([0.1, 0.9]));
    }

    #[test]
    fn no_two_curves_look_alike() {
        let count = COLORS.len();
        let all: Vec<Curve> = (0..count)
            .map(|_| curve(&[(1.0, 0.5), (2.0, 0.1)]))
            .collect();
        let svg = curves(&AXES, &all).unwrap().unwrap();
        for color in COLORS {
            let RGBColor(r, g, b) = color;
            assert!(svg.contains(&format!("#{r:02X}{g:02X}{b:02X}")), "{svg}");
        }
        // What lies below a dashed curve shows in its gaps.
        let solid = curves(&AXES, &all[..SOLID]).unwrap().unwrap();
        let lines = |svg: &str| svg.matches("<polyline").count();
        assert!(lines(&svg) > 2 * lines(&solid));
    }

    #[test]
    fn bars_of_one_name_are_one_entry_of_the_legend() {
        let group = |name: &str| Group {
            name: name.to_owned(),
            bars: vec![("standard".to_owned(), 3.0), ("lie".to_owned(), 1.0)],
        };
        let svg = bars(
            "Times",
            "ms",
            &[group("bar"), group("mosque"), group("third")],
        );
        let svg = svg.unwrap().unwrap();
        for text in ["bar", "mosque", "third", "standard"] {
            assert_eq!(
                svg.matches(&format!("\n{text}\n")).count(),
                1,
                "{text} in {svg}"
            );
        }
        assert_eq!(bars("Times", "ms", &[]).unwrap(), None);
        let nothing = Group {
            name: "x".to_owned(),
            bars: vec![("y".to_owned(), f64::NAN)],
        };
        assert_eq!(bars("Times", "ms", &[nothing]).unwrap(), None);
    }

    #[test]
    fn ranges_are_whole_decades() {
        let whole = |values: &[f64]| {
            let range = decades(values.iter().copied());
            (range.start.log10().round(), range.end.log10().round())
        };
        assert_eq!(whole(&[0.02, 3.0]), (-2.0, 1.0));
        assert_eq!(whole(&[1.0]), (0.0, 1.0));
        let range = decades([0.1, 1.0].into_iter());
        assert!(range.start < 0.1 && range.end > 1.0);
    }
}
