//! Resolution of a measurement protocol (thesis figure 5.10) to the speed profile and the kicks that it is short for.

use crate::study::error::{Fault, StudyError};
use crate::study::file::source::Source;
use crate::study::file::stages_file::{
    DirectionFile, DisturbanceFile, HammerFile, KickFile, ProfilePartFile, ProtocolFile,
    ProtocolKeys, ProtocolName, RampFile, StartupFile,
};
use crate::study::file::study_file::ModelFile;
use crate::study::file::yaml_tree::describe_number;

/// The slowest speed of the thesis's motor, rad/s.
const SLOWEST_RAD_S: f64 = 31.0;
/// The default duration of the ramp, s.
const OVER_S: f64 = 2.0;
/// The default time between two hits, s.
const WAIT_S: f64 = 5.0;
/// The default change of the table's velocity in a hit, m/s.
const HIT_M_S: f64 = 0.01;

/// The speed profile and the disturbances of a model, as they are written.
#[derive(Debug, Default)]
pub(in crate::study) struct StagesFile {
    pub speed_profile: Option<Vec<ProfilePartFile>>,
    pub disturbances: Option<Vec<DisturbanceFile>>,
}

/// Returns the speed profile and the disturbances of the model, which its protocol may be short for.
pub(in crate::study) fn stages_of(
    source: &Source,
    written: &ModelFile,
    speed_rad_s: f64,
) -> Result<StagesFile, StudyError> {
    let Some(protocol) = &written.protocol else {
        return Ok(StagesFile {
            speed_profile: written.speed_profile.clone(),
            disturbances: written.disturbances.clone(),
        });
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
    let (start, hammer) = match protocol {
        ProtocolFile::Named(ProtocolName::Startup) => (StartupFile::default(), None),
        ProtocolFile::Named(ProtocolName::StartupAndHammer) => {
            (StartupFile::default(), Some(HammerFile::default()))
        }
        ProtocolFile::With(ProtocolKeys::Startup(start)) => (start.clone(), None),
        ProtocolFile::With(ProtocolKeys::StartupAndHammer(hammer)) => {
            let start = StartupFile { from_rad_s: hammer.from_rad_s, over_s: hammer.over_s };
            (start, Some(hammer.clone()))
        }
    };
    let path = path.key(if hammer.is_some() { "startup_and_hammer" } else { "startup" });
    let over_s = start.over_s.unwrap_or(OVER_S);
    let slowest = SLOWEST_RAD_S.copysign(speed_rad_s);
    let from_rad_s = start.from_rad_s.unwrap_or(slowest);
    if from_rad_s * speed_rad_s <= 0.0 {
        let allowed = format!("a speed with the sign of {}", describe_number(speed_rad_s));
        let fault = Fault::new("not a first speed", describe_number(from_rad_s), allowed);
        return Err(path.key("from_rad_s").refuse_value(fault));
    }
    let ramp = RampFile { from_rad_s: Some(from_rad_s), to_rad_s: None, over_s };
    let mut profile = vec![ProfilePartFile::Ramp(ramp)];
    let Some(hammer) = hammer else {
        return Ok(StagesFile { speed_profile: Some(profile), disturbances: None });
    };
    let wait_s = hammer.wait_s.unwrap_or(WAIT_S);
    let hits = hammer.hits.unwrap_or(1);
    let speed_m_s = hammer.speed_m_s.unwrap_or(HIT_M_S);
    profile.push(ProfilePartFile::HoldS((hits + 1) as f64 * wait_s));
    let hit = |number: u64| {
        let at_s = over_s + number as f64 * wait_s;
        let direction = Some(DirectionFile::Random);
        DisturbanceFile::Kick(KickFile { at_s, speed_m_s, direction, direction_rad: None })
    };
    let disturbances = Some((1..=hits).map(hit).collect());
    Ok(StagesFile { speed_profile: Some(profile), disturbances })
}
