//! Resolution of the speed profile and the disturbances, or of the measurement protocol (thesis figure 5.10) that is short for
//! them, and the reverse.

use crate::model::{Kick, Model, ProfilePart, Ramp, RampShape, Simulation, SpeedProfile};
use crate::study::error::{Fault, StudyError, describe_number, from_to};
use crate::study::file::model_parts::{
    DirectionFile, DisturbanceFile, HammerFile, KickFile, ProfilePartFile, ProtocolFile,
    ProtocolKeys, ProtocolName, RampFile, StartupFile,
};
use crate::study::file::source::{Source, SourcePath};
use crate::study::file::study_file::ModelFile;
use crate::study::file::table_input::values_over_time;
use crate::study::file::values::TableKey;
use crate::study::plan::parameter::MOST_MEMBERS;

/// The columns of the table of a speed profile.
const COLUMNS: [&str; 2] = ["time_s", "speed_rad_s"];

/// The slowest speed of the thesis's motor, rad/s.
const SLOWEST_RAD_S: f64 = 31.0;
/// The default duration of the ramp, s.
const OVER_S: f64 = 2.0;
/// The default time between two hits, s.
const WAIT_S: f64 = 5.0;
/// The default change of the table's velocity in a hit, m/s.
const HIT_M_S: f64 = 0.01;

/// The speed profile and the disturbances of a model, as they are written.
type WrittenStages = (Option<Vec<ProfilePartFile>>, Option<Vec<DisturbanceFile>>);

/// Returns the speed profile and the disturbances of the model, which its protocol may be short for.
pub(in crate::study) fn stages_of(
    source: &Source,
    written: &ModelFile,
    speed_rad_s: f64,
) -> Result<WrittenStages, StudyError> {
    let Some(protocol) = &written.protocol else {
        return Ok((written.speed_profile.clone(), written.disturbances.clone()));
    };
    let path = source.path("model.protocol");
    let beside = [
        ("speed_profile", written.speed_profile.is_some()),
        ("disturbances", written.disturbances.is_some()),
    ];
    if let Some((key, _)) = beside.into_iter().find(|(_, is_given)| *is_given) {
        let problem = "a protocol is short for a speed profile and disturbances";
        let found = format!("{key} beside protocol");
        return Err(path.wrong_value(problem, found, "one of both"));
    }
    // A start has the numbers of a start with hits that concern the ramp.
    let startup = |StartupFile { from_rad_s, over_s }: StartupFile| HammerFile {
        from_rad_s,
        over_s,
        ..HammerFile::default()
    };
    let (numbers, has_hits) = match protocol.clone() {
        ProtocolFile::Named(name) => {
            (HammerFile::default(), name == ProtocolName::StartupAndHammer)
        }
        ProtocolFile::With(ProtocolKeys::Startup(start)) => (startup(start), false),
        ProtocolFile::With(ProtocolKeys::StartupAndHammer(hammer)) => (hammer, true),
    };
    let over_s = numbers.over_s.unwrap_or(OVER_S);
    let from_rad_s = numbers.from_rad_s.unwrap_or(SLOWEST_RAD_S.copysign(speed_rad_s));
    if from_rad_s * speed_rad_s <= 0.0 {
        let allowed = format!("a speed with the sign of {}", describe_number(speed_rad_s));
        let fault = Fault::new("not a first speed", describe_number(from_rad_s), allowed);
        return Err(path.chosen().key("from_rad_s").refuse_value(fault));
    }
    let ramp = RampFile { from_rad_s: Some(from_rad_s), to_rad_s: None, over_s };
    let mut profile = vec![ProfilePartFile::Ramp(ramp)];
    if !has_hits {
        return Ok((Some(profile), None));
    }
    let wait_s = numbers.wait_s.unwrap_or(WAIT_S);
    let hits = numbers.hits.unwrap_or(1);
    let speed_m_s = numbers.speed_m_s.unwrap_or(HIT_M_S);
    profile.push(ProfilePartFile::HoldS((hits + 1) as f64 * wait_s));
    let hit = |number: u64| {
        let at_s = over_s + number as f64 * wait_s;
        let direction = Some(DirectionFile::Random);
        DisturbanceFile::Kick(KickFile { at_s, speed_m_s, direction, direction_rad: None })
    };
    Ok((Some(profile), Some((1..=hits).map(hit).collect())))
}

/// Returns the speed profile and the last speed, rad/s. `last` is the speed of the parameters, and whether the study gives
/// it.
///
/// # Errors
/// Returns an error if speeds do not follow one another, if the last speed is not that of the parameters, or if a value is
/// not possible.
pub(in crate::study) fn resolve_profile(
    path: &SourcePath<'_>,
    written: &[ProfilePartFile],
    (last, is_given): (f64, bool),
) -> Result<(SpeedProfile, f64), StudyError> {
    check_number(path, written.len(), "parts; a table may have any number of rows")?;
    let given = is_given.then_some(last);
    let last_change = written.iter().rposition(|part| !matches!(part, ProfilePartFile::HoldS(_)));
    let mut parts = Vec::new();
    let mut start = None;
    let mut speed: Option<f64> = None;
    for (place, part) in written.iter().enumerate() {
        let path = path.item(place);
        let mut ramp = |key: &str, shape: RampShape, ramp: &RampFile| {
            let path = path.key(key);
            let from = begin(&path, ramp.from_rad_s, speed)?;
            start.get_or_insert(from);
            let is_last = last_change == Some(place);
            let to = match (ramp.to_rad_s, given) {
                (Some(to), Some(given)) if is_last && to != given => {
                    let problem = "another speed than the last one of the profile";
                    let allowed = format!("{}, or no such key", describe_number(given));
                    let fault = Fault::new(problem, describe_number(to), allowed);
                    return Err(path.key("to_rad_s").refuse_value(fault));
                }
                (Some(to), _) => to,
                (None, _) if is_last => last,
                (None, _) => {
                    let allowed = "a key to_rad_s; only the last ramp leads to speed_rad_s";
                    let problem = "the speed at the end is missing";
                    return Err(path.wrong_value(problem, "no such key", allowed));
                }
            };
            if from * to <= 0.0 {
                let allowed = "speeds of one sign, other than 0";
                let problem = "the speed changes its sign";
                return Err(path.wrong_value(problem, from_to(from, to), allowed));
            }
            speed = Some(to);
            let to_rad_s = (!is_last).then_some(to);
            Ok(ProfilePart::Ramp(Ramp { shape, to_rad_s, over_s: ramp.over_s }))
        };
        parts.push(match part {
            ProfilePartFile::Ramp(linear) => ramp("ramp", RampShape::Linear, linear)?,
            ProfilePartFile::SmoothRamp(smooth) => ramp("smooth_ramp", RampShape::Smooth, smooth)?,
            ProfilePartFile::HoldS(lasts_s) => {
                if speed.is_none() {
                    // A plateau at the start is at the only speed that the study gives.
                    let only = last_change.is_none().then_some(last);
                    let allowed = "a ramp or a table as the first part";
                    let fault = Fault::new("the first speed is missing", "hold_s", allowed);
                    speed = Some(only.ok_or_else(|| path.refuse_value(fault))?);
                    start = speed;
                }
                ProfilePart::Hold(Some(*lasts_s))
            }
            ProfilePartFile::Table(table) => {
                let rows = values_over_time(&path.key("table"), table, COLUMNS.map(str::to_owned))?;
                let [first, last] = [rows[0][1], rows[rows.len() - 1][1]];
                start.get_or_insert(begin(&path, Some(first), speed)?);
                speed = Some(last);
                ProfilePart::Table(rows)
            }
        });
    }
    let (Some(start_speed_rad_s), Some(last)) = (start, speed) else {
        return Err(path.wrong_value("no parts", "an empty list", "at least one part"));
    };
    if let Some(given) = given.filter(|given| *given != last) {
        let found = format!(
            "{}, while the profile ends at {}",
            describe_number(given),
            describe_number(last)
        );
        return Err(path.wrong_value(
            "not the last speed of the profile",
            found,
            "the same speed, or no such key",
        ));
    }
    Ok((SpeedProfile { start_speed_rad_s, parts }, last))
}

/// Returns the speed at the begin of a part, which is that at the end of the part before.
fn begin(path: &SourcePath<'_>, from: Option<f64>, before: Option<f64>) -> Result<f64, StudyError> {
    match (from, before) {
        (None, None) => {
            Err(path.wrong_value("the first speed is missing", "no such key", "a key from_rad_s"))
        }
        (Some(from), Some(before)) if from != before => {
            let found = describe_number(from);
            let allowed = format!("{}, the speed before", describe_number(before));
            Err(path.wrong_value("the speed jumps", found, allowed))
        }
        (from, before) => Ok(before.or(from).unwrap_or_default()),
    }
}

fn check_number(path: &SourcePath<'_>, number: usize, what: &str) -> Result<(), StudyError> {
    if number <= MOST_MEMBERS {
        return Ok(());
    }
    let allowed = format!("at most {MOST_MEMBERS} {what}");
    Err(path.wrong_value("too many", number.to_string(), allowed))
}

/// Returns the kicks, and for each whether its direction is drawn.
pub(in crate::study) fn resolve_kicks(
    path: &SourcePath<'_>,
    written: &[DisturbanceFile],
) -> Result<Vec<(Kick, bool)>, StudyError> {
    check_number(path, written.len(), "kicks")?;
    let kick = |(place, DisturbanceFile::Kick(kick)): (usize, &DisturbanceFile)| {
        if kick.direction.is_some() && kick.direction_rad.is_some() {
            let found = "direction_rad beside direction";
            let fault = Fault::new("the direction is given twice", found, "one of both");
            return Err(path.item(place).key("kick").key("direction_rad").refuse_key(fault));
        }
        let direction_rad = kick.direction_rad.unwrap_or_default();
        let resolved = Kick { at_s: kick.at_s, speed_m_s: kick.speed_m_s, direction_rad };
        Ok((resolved, kick.direction_rad.is_none()))
    };
    written.iter().enumerate().map(kick).collect()
}

/// Checks the speed profile, or the speed of a model without one.
pub(in crate::study) fn check_stages(source: &Source, model: &Model) -> Result<(), StudyError> {
    let Err(invalid) = model.validate_stages() else { return Ok(()) };
    let has_profile = model.speed_profile().is_some();
    let path = source.path(if has_profile { "model.speed_profile" } else { "model" });
    let problem = format!("no physical meaning: {}", invalid.name);
    Err(path.wrong_value(problem, invalid.found, invalid.allowed))
}

/// Checks that all kicks come before the end of the runs, and that runs to be continued reach their last stage before.
pub(in crate::study) fn check_kicks(
    source: &Source,
    model: &Model,
    simulation: &Simulation,
) -> Result<(), StudyError> {
    if let Err(invalid) = model.validate_extension(simulation) {
        let problem = "runs end before their last stage";
        return Err(source.path("simulation").wrong_value(problem, invalid.found, invalid.allowed));
    }
    let Err(invalid) = model.validate_kicks(simulation.end_time_s) else { return Ok(()) };
    let kicks = model.ball_balancer().into_iter().flat_map(|machine| &machine.kicks);
    let late = kicks.enumerate().find(|(_, kick)| kick.at_s >= simulation.end_time_s);
    let path = source.path("model.disturbances").item(late.map_or(0, |(place, _)| place));
    let fault = Fault::new("a kick after the end of the run", invalid.found, invalid.allowed);
    Err(path.key("kick").key("at_s").refuse_value(fault))
}

/// Returns the profile in the form of a study file.
pub(in crate::study) fn profile_to_file(profile: &SpeedProfile) -> Vec<ProfilePartFile> {
    let part = |(place, part): (usize, &ProfilePart)| match part {
        ProfilePart::Ramp(Ramp { shape, to_rad_s, over_s }) => {
            let ramp = RampFile {
                from_rad_s: (place == 0).then_some(profile.start_speed_rad_s),
                to_rad_s: *to_rad_s,
                over_s: *over_s,
            };
            match shape {
                RampShape::Linear => ProfilePartFile::Ramp(ramp),
                RampShape::Smooth => ProfilePartFile::SmoothRamp(ramp),
            }
        }
        ProfilePart::Hold(lasts_s) => ProfilePartFile::HoldS(lasts_s.unwrap_or_default()),
        ProfilePart::Table(rows) => {
            let columns = COLUMNS.map(str::to_owned).to_vec();
            let rows = rows.iter().map(|row| &row[..]);
            ProfilePartFile::Table(TableKey::of_numbers(columns, rows))
        }
    };
    profile.parts.iter().enumerate().map(part).collect()
}

/// Returns the kicks in the form of a study file.
pub(in crate::study) fn kicks_to_file(kicks: &[Kick], random: &[usize]) -> Vec<DisturbanceFile> {
    let kick = |(number, kick): (usize, &Kick)| {
        let is_drawn = random.contains(&number);
        DisturbanceFile::Kick(KickFile {
            at_s: kick.at_s,
            speed_m_s: kick.speed_m_s,
            direction: is_drawn.then_some(DirectionFile::Random),
            direction_rad: (!is_drawn).then_some(kick.direction_rad),
        })
    };
    (1..).zip(kicks).map(kick).collect()
}
