//! Which runs are computed a second time, to see whether their endings depend on how they are
//! computed.

use super::design::SampleId;
use super::draw::DrawKey;
use super::error::{Fault, Locate, StudyError};
use super::file::AuditFile;
use super::key_path::KeyPath;
use super::node::describe_number;
use super::parameter::{Parameter, ParameterValue};

/// A fraction of the runs that is computed once more, by [`crate::model::Simulation::counter_check`].
///
/// A run is chosen where its own uniform number, keyed by the swept values of its point, its cell
/// and its replicate, is below the fraction: more samples, further points and a larger fraction keep all
/// former choices, and points have different ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Audit {
    /// The fraction of the runs, above 0 and at most 1.
    pub fraction: f64,
}

impl Audit {
    /// Checks an audit.
    ///
    /// # Errors
    /// A fraction that is none, or zero.
    pub(super) fn resolve(
        locate: &dyn Locate,
        written: Option<&AuditFile>,
    ) -> Result<Option<Audit>, StudyError> {
        let Some(AuditFile { fraction }) = written.copied() else { return Ok(None) };
        if 0.0 < fraction && fraction <= 1.0 {
            return Ok(Some(Audit { fraction }));
        }
        let allowed = "a fraction of the runs above 0 and at most 1, such as 0.05, or no `audit`";
        let fault = Fault::new("not a fraction of the runs", describe_number(fraction), allowed);
        Err(locate.refuse_value(&KeyPath::of("audit.fraction"), fault))
    }

    /// As a study file writes it.
    pub(super) fn to_file(self) -> AuditFile {
        AuditFile { fraction: self.fraction }
    }

    /// Whether a sample at the point with these swept values is chosen.
    pub(super) fn chooses(
        self,
        seed: u64,
        swept: &[(Parameter, ParameterValue)],
        id: SampleId,
    ) -> bool {
        let key = DrawKey::new(seed, "audit", &name(swept));
        key.uniform(id.cell, id.replicate) < self.fraction
    }
}

/// The swept values of a point as text, whatever the order in which the sweep names them.
fn name(swept: &[(Parameter, ParameterValue)]) -> String {
    let text = |(parameter, value): &(Parameter, ParameterValue)| match value {
        // Adding 0 makes -0 to 0; the exponent form gives back every digit.
        ParameterValue::Number(number) => format!("{}={:e}", parameter.name(), number + 0.0),
        ParameterValue::Text(word) => format!("{}={word}", parameter.name()),
    };
    let mut values: Vec<String> = swept.iter().map(text).collect();
    values.sort_unstable();
    values.join(",")
}
