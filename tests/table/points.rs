//! A row of the points' table is read back by the columns that wrote it.

use stickslip::analysis::{
    AuditCounts, ConfidenceInterval, Estimate, IntervalMethod, PointSummary, ResidualVibration,
};
use stickslip::classification::Label;
use stickslip::table::{PointRow, Table, in_memory, point_columns};

use crate::cli::support::{AT_ONCE, parse, study_text};

#[test]
fn columns_read_what_they_write() {
    let rest = "sweep: [{grid: {speed_rad_s: [-160.0, -170.0]}}]\naudit: {fraction: 0.5}\nresponses:\n  \
                vibration: {amplitude_mean: {}}\n  rests: {at_rest_by_s: 1.0e-6}\n";
    let study = parse(study_text("a", "{monte_carlo: {samples: 5}}", AT_ONCE, rest));
    let mut last = 0.0;
    let mut next = || {
        last += 0.1;
        last
    };
    let mut summary = PointSummary {
        equilibrium_fraction: next(),
        interval: ConfidenceInterval {
            low: next(),
            high: next(),
            method: IntervalMethod::Stratified,
        },
        time_to_rest_s: [Some(next()), Some(next()), Some(next()), None],
        amplitude_m: [(); 3].map(|()| Some(next())),
        amplitude_interval_m: [[None, Some(next())], [(); 2].map(|()| Some(next())), [None; 2]],
        residual: ResidualVibration {
            amplitude_without_balls_m: Some(next()),
            relative_amplitude: [(); 3].map(|()| Some(next())),
            worse_than_without_balls: Some([(); 3].map(|()| next())),
            balance_quality_grade_mm_s: [(); 2].map(|()| Some(next())),
            overlapping_rest_fraction: Some(next()),
        },
        audit: AuditCounts { runs: 3, flips: 2, rest_flips: 1 },
        ..PointSummary::default()
    };
    for (label, runs) in Label::ALL.into_iter().zip(1..) {
        summary.counts.add_many(label, runs);
    }
    let known = Estimate {
        reason: Some("few runs".into()),
        ..Estimate::known(next(), next(), [next(), next()])
    };
    let written = PointRow {
        point_id: 1,
        swept: study.point(1).swept,
        summary,
        responses: vec![known, Estimate::unknown("no runs")],
        responses_without_balls: vec![Some(next()), None],
        set_fraction: Some(next()),
        ..PointRow::default()
    };
    let table = in_memory(point_columns(&study), "{}", [written.clone()]).expect("a table");
    let table = Table::of_memory("points", Some(table)).expect("a table");
    let columns = point_columns(&study);
    let rows = table.read_rows(|row| PointRow::read(&study, &columns, row)).expect("all columns");
    let read: Vec<PointRow> = rows.filter_map(|row| row.expect("a row")).collect();
    assert_eq!(read, [written]);
}
