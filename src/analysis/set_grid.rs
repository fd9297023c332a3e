//! The equilibrium set of one or two balls on a regular grid of their angles.
//!
//! Grid points are at `2πk/G` on each axis, which includes the imbalance's direction and the
//! diagonals. Sines and cosines are computed once per axis, so that a row of the grid costs about
//! twenty multiplications per point and is vectorised.

use std::f64::consts::TAU;
use std::ops::Range;

use rayon::prelude::*;

use super::rest_form::{AtRest, RestForm, direction, holding, is_held, larger};
use super::set_components::{Run, SetRuns};
use crate::model::wrap_to_two_pi;

/// A grid over the angles of one ball or two.
#[derive(Clone, Debug)]
pub struct SetGrid<'a> {
    form: &'a RestForm,
    points: usize,
    cosine: Vec<f64>,
    sine: Vec<f64>,
    /// For each ball, the displacement of the ring's centre that it causes at each point of its axis.
    push: Vec<[Vec<f64>; 2]>,
}

/// One row of a grid: all angles of the last ball, with the first ball fixed.
#[derive(Clone, Debug, Default)]
pub struct GridRow {
    amplitude_squared: Vec<f64>,
    required: Vec<f64>,
    used: Vec<f64>,
}

/// The result over all rows of the grid.
#[derive(Clone, Debug)]
pub struct GridSummary {
    /// Points of the grid in the set.
    pub inside: u64,
    /// Points of the grid at which no balls with contact overlap.
    pub possible: u64,
    /// The smallest and the largest amplitude at points of the set, non-dimensional, each with the
    /// point's row and column; `None` if no point is in the set.
    pub amplitudes: Option<[(f64, [usize; 2]); 2]>,
    /// The runs of the set.
    pub runs: SetRuns,
}

struct RowSummary {
    inside: u64,
    amplitudes: Option<[(f64, [usize; 2]); 2]>,
    runs: Vec<Run>,
}

impl<'a> SetGrid<'a> {
    /// Returns a grid of `points` per axis, or `None` for more than two balls.
    pub fn new(form: &'a RestForm, points: usize) -> Option<Self> {
        if form.mass.len() > 2 || points == 0 {
            return None;
        }
        let directions = (0..points).map(|k| direction(Self::angle(k, points)));
        let (cosine, sine): (Vec<f64>, Vec<f64>) = directions.map(|e| (e.re, e.im)).unzip();
        let push = form.mass.iter().map(|&mass| {
            let g = form.transfer * mass;
            let each = || cosine.iter().zip(&sine);
            let x = each().map(|(c, s)| g.re * c - g.im * s).collect();
            let y = each().map(|(c, s)| g.re * s + g.im * c).collect();
            [x, y]
        });
        let push = push.collect();
        Some(SetGrid { form, points, cosine, sine, push })
    }

    fn angle(index: usize, points: usize) -> f64 {
        index as f64 / points as f64 * TAU
    }

    /// Returns the number of rows; 1 for one ball.
    pub fn rows(&self) -> usize {
        if self.push.len() == 1 { 1 } else { self.points }
    }

    /// Returns the total number of points.
    pub fn size(&self) -> u64 {
        self.rows() as u64 * self.points as u64
    }

    /// Returns the balls' angles at a point, one per ball, rad.
    pub fn beta(&self, row: usize, column: usize) -> Vec<f64> {
        let last = Self::angle(column, self.points);
        if self.push.len() == 1 { vec![last] } else { vec![Self::angle(row, self.points), last] }
    }

    /// Computes a row.
    pub fn fill(&self, row: usize, values: &mut GridRow) {
        let points = self.points;
        let imbalance = self.form.transfer * self.form.imbalance;
        let runout = self.form.runout;
        let last = self.push.len() - 1; // at least one ball, see `RestForm::new`
        let first = (last == 1).then(|| [self.push[0][0][row], self.push[0][1][row]]);
        let [first_x, first_y] = first.unwrap_or_default();
        let coefficient = self.form.friction_coefficient[last];
        for list in [&mut values.amplitude_squared, &mut values.required, &mut values.used] {
            list.resize(points, 0.0);
        }
        let [push_x, push_y] = &self.push[last];
        let amplitude_squared = &mut values.amplitude_squared[..points];
        let required = &mut values.required[..points];
        let used = &mut values.used[..points];
        let (push_x, push_y) = (&push_x[..points], &push_y[..points]);
        let (cosine, sine) = (&self.cosine[..points], &self.sine[..points]);
        // The balls' displacements are added first, so that exchanging identical balls gives equal
        // bits.
        for j in 0..points {
            let x = imbalance.re + (first_x + push_x[j]);
            let y = imbalance.im + (first_y + push_y[j]);
            let table = [x - runout.re, y - runout.im];
            amplitude_squared[j] = table[0] * table[0] + table[1] * table[1];
            (required[j], used[j]) = holding([x, y], [cosine[j], sine[j]], coefficient);
        }
        if last == 0 {
            return;
        }
        let held = [cosine[row], sine[row]];
        let coefficient = self.form.friction_coefficient[0];
        for j in 0..points {
            let x = imbalance.re + (first_x + push_x[j]);
            let y = imbalance.im + (first_y + push_y[j]);
            let (first_required, first_used) = holding([x, y], held, coefficient);
            required[j] = larger(required[j], first_required);
            used[j] = larger(used[j], first_used);
        }
    }

    /// Returns a point of a computed row.
    pub fn at(&self, values: &GridRow, column: usize) -> AtRest {
        AtRest {
            amplitude_m: values.amplitude_squared[column].sqrt() * self.form.ring_radius_m,
            required_friction: values.required[column],
            friction_used: values.used[column],
        }
    }

    /// Returns whether a corner of the grid cell around a position is in the set.
    pub fn sees(&self, beta: &[f64]) -> bool {
        let points = self.points;
        let corner = |corners: usize| -> Vec<f64> {
            let along = |(axis, beta): (usize, &f64)| {
                let cell = (beta / TAU * points as f64).floor() as usize;
                Self::angle((cell + (corners >> axis & 1)) % points, points)
            };
            beta.iter().enumerate().map(along).collect()
        };
        if !self.form.closed_gaps(beta).is_empty() {
            // Positions in which balls touch are examined at the angles of the rows.
            return [0, 1].into_iter().any(|corners| {
                let turn = corner(corners)[0] - beta[0];
                let there: Vec<f64> = beta.iter().map(|beta| wrap_to_two_pi(beta + turn)).collect();
                self.form.holds_with_forces(&there)
            });
        }
        (0..1_usize << beta.len()).any(|corners| self.form.at_rest(&corner(corners)).in_set())
    }

    /// Returns the fraction of the grid's points that are in the set of two balls, of those at which balls with contact do not
    /// overlap, on the calling thread.
    pub fn fraction(&self) -> f64 {
        let rows = 0..self.rows();
        if self.has_contact() {
            let inside = rows.map(|row| self.possible(row).map(|part| self.count(row, part)));
            let inside: u64 = inside.flatten().sum();
            return inside as f64 / self.possible_points().max(1) as f64;
        }
        let inside = match &self.push[..] {
            [_, _] if self.form.balls[0] == self.form.balls[1] => {
                // Exchanging the balls gives equal bits: half of the grid suffices.
                let half = (0..self.rows()).map(|row| {
                    2 * self.count(row, row + 1..self.points) + self.count(row, row..row + 1)
                });
                half.sum::<u64>()
            }
            _ => (0..self.rows()).map(|row| self.count(row, 0..self.points)).sum(),
        };
        inside as f64 / self.size() as f64
    }

    fn has_contact(&self) -> bool {
        self.push.len() == 2 && self.form.touching.is_some()
    }

    /// Returns the first and the last place ahead of a row at which two balls do not overlap.
    fn apart(&self) -> [usize; 2] {
        let angle = if self.has_contact() { self.form.touching_angle(0, 1) } else { 0.0 };
        let first = (angle / Self::angle(1, self.points)).ceil() as usize;
        [first, self.points.saturating_sub(first)]
    }

    /// Returns the number of points of the grid at which two balls with contact do not overlap.
    fn possible_points(&self) -> u64 {
        let [first, last] = self.apart();
        self.rows() as u64 * (last + 1).saturating_sub(first) as u64
    }

    /// Returns the columns of a row, in two parts, at which two balls with contact do not overlap.
    fn possible(&self, row: usize) -> [Range<usize>; 2] {
        let points = self.points;
        let [first, last] = self.apart();
        let (from, to) = (row + first, (row + last + 1).max(row + first));
        [from.min(points)..to.min(points), from.max(points) - points..to.max(points) - points]
    }

    /// Adds the touching positions of two balls to the runs of a row: where friction holds them, the nearest possible point
    /// counts as connected to the set.
    fn with_touching(&self, row: usize, inside: &mut [bool]) {
        let [first, last] = self.apart();
        let (here, touching) = (Self::angle(row, self.points), self.form.touching_angle(0, 1));
        for (ahead, place) in [(touching, first), (-touching, last)] {
            let beta = [here, wrap_to_two_pi(here + ahead)];
            inside[(row + place) % self.points] |= self.form.holds_with_forces(&beta);
        }
    }

    /// Returns how many points of a range of columns of a row are in the set of two balls.
    fn count(&self, row: usize, columns: Range<usize>) -> u64 {
        let [[first_x, first_y], [push_x, push_y]] = &self.push[..] else { return 0 };
        let imbalance = self.form.transfer * self.form.imbalance;
        let [of_first, coefficient] = [0, 1].map(|ball| self.form.friction_coefficient[ball]);
        let (push_x, push_y) = (&push_x[columns.clone()], &push_y[columns.clone()]);
        let (cosine, sine) = (&self.cosine[columns.clone()], &self.sine[columns]);
        let directions = cosine.iter().zip(sine).map(|(&c, &s)| [c, s]);
        let points = push_x.iter().zip(push_y).zip(directions);
        let [first_x, first_y] = [first_x[row], first_y[row]];
        let first = [self.cosine[row], self.sine[row]];
        let held = points.map(|((push_x, push_y), direction)| {
            let z = [imbalance.re + (first_x + push_x), imbalance.im + (first_y + push_y)];
            u64::from(is_held(z, direction, coefficient) & is_held(z, first, of_first))
        });
        held.sum()
    }

    /// Returns the whole set, computed on the current thread pool.
    pub fn summary(&self) -> GridSummary {
        let rows: Vec<RowSummary> = (0..self.rows())
            .into_par_iter()
            .map_init(GridRow::default, |values, row| self.row_summary(row, values))
            .collect();
        let inside = rows.iter().map(|row| row.inside).sum();
        let amplitudes = rows.iter().filter_map(|row| row.amplitudes);
        let amplitudes = amplitudes.reduce(|[low, high], [least, most]| {
            [if least.0 < low.0 { least } else { low }, if most.0 > high.0 { most } else { high }]
        });
        let runs = SetRuns {
            columns: self.points as u32,
            rows: rows.into_iter().map(|row| row.runs).collect(),
        };
        let possible = if self.has_contact() { self.possible_points() } else { self.size() };
        GridSummary { inside, possible, amplitudes, runs }
    }

    fn row_summary(&self, row: usize, values: &mut GridRow) -> RowSummary {
        self.fill(row, values);
        let mut inside: Vec<bool> = values.used.iter().map(|used| *used <= 1.0).collect();
        if self.has_contact() {
            let parts = self.possible(row);
            let possible = |column: usize| parts.iter().any(|part| part.contains(&column));
            (0..).zip(&mut inside).for_each(|(column, inside)| *inside &= possible(column));
        }
        let mut extremes: Option<[(f64, usize); 2]> = None;
        for column in (0..self.points).filter(|column| inside[*column]) {
            let here = (values.amplitude_squared[column], column);
            let [low, high] = extremes.get_or_insert([here; 2]);
            if here.0 < low.0 {
                *low = here;
            }
            if here.0 > high.0 {
                *high = here;
            }
        }
        let number = inside.iter().filter(|inside| **inside).count() as u64;
        if self.has_contact() {
            self.with_touching(row, &mut inside);
        }
        RowSummary {
            inside: number,
            amplitudes: extremes
                .map(|both| both.map(|(squared, column)| (squared.sqrt(), [row, column]))),
            runs: SetRuns::of_row(inside.into_iter()),
        }
    }
}
