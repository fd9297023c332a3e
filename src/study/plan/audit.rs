//! The audit: which runs are recomputed by the other method.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::sampling::draw::DrawKey;
use crate::study::sampling::sampling_design::SampleId;

/// Recomputation of randomly chosen runs by the other method, with a tenth of both tolerances; it
/// measures how often the label depends on the computation.
// A run is selected if a uniform random number is below the fraction. The number is keyed by the
// swept values of the point, the cell and the replicate. More samples, more points or a larger
// fraction therefore keep all earlier selections, and each point has its own selection.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(deny_unknown_fields)]
#[schemars(rename = "AuditFile")]
pub struct Audit {
    /// Fraction of the runs that are recomputed, above 0 and at most 1.
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1))]
    pub fraction: f64,
}

impl Audit {
    /// Returns whether the audit selects a sample at the point with these swept values.
    pub(in crate::study) fn chooses(
        self,
        seed: u64,
        swept: &[(Parameter, ParameterValue)],
        id: SampleId,
    ) -> bool {
        let key = DrawKey::new(seed, "audit", &name(swept));
        key.uniform(id.cell, id.replicate) < self.fraction
    }
}

/// Returns the swept values of a point as text that does not depend on the order of the sweep.
fn name(swept: &[(Parameter, ParameterValue)]) -> String {
    let text = |(parameter, value): &(Parameter, ParameterValue)| match value {
        // Adding 0 turns -0 into 0; the exponent form keeps every digit.
        ParameterValue::Number(number) => format!("{}={:e}", parameter.name(), number + 0.0),
        ParameterValue::Text(word) => format!("{}={word}", parameter.name()),
    };
    let mut values: Vec<String> = swept.iter().map(text).collect();
    values.sort_unstable();
    values.join(",")
}
