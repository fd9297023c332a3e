//! Resolution of the joint sampling of the uncertain parameters: their design in each block, and their correlations.

use crate::study::error::{Fault, StudyError, describe_number, list_names};
use crate::study::file::key_units::split_unit;
use crate::study::file::source::{Source, SourcePath};
use crate::study::file::uncertain_file::{
    CorrelationFile, UncertainDesignKind, UncertainSamplingFile,
};
use crate::study::plan::precision::{Precision, Sampling};
use crate::study::plan::uncertain_parameter::UncertainParameter;
use crate::study::resolve::sampling::check_dimensions;
use crate::study::sampling::correlation::{Contradiction, Copula, CorrelatedPair};
use crate::study::sampling::sampling_design::{Design, Layout, MAX_SOBOL_SAMPLES};
use crate::study::sampling::uncertain_design::UncertainDesign;

/// The validated key `uncertain_sampling`.
#[derive(Clone)]
pub(crate) struct UncertainSampling<'a> {
    /// Which design the uncertain parameters have.
    pub kind: UncertainDesignKind,
    /// Their correlations, if there are any.
    pub copula: Option<Copula>,
    /// The key with all defaults and in the order of the model's parameters, or `None` if all draws are independent.
    pub file: Option<UncertainSamplingFile>,
    names: Vec<String>,
    seed: u64,
    path: SourcePath<'a>,
}

impl<'a> UncertainSampling<'a> {
    /// Validates the key.
    ///
    /// # Errors
    /// Returns an error if no parameter is uncertain, if a pair does not consist of two different uncertain parameters or
    /// is given twice, if a rank correlation is not above -1 and below 1, or if the correlations contradict one another.
    pub fn resolve(
        source: &'a Source,
        written: Option<&UncertainSamplingFile>,
        uncertain: &[UncertainParameter],
        seed: u64,
    ) -> Result<UncertainSampling<'a>, StudyError> {
        let path = source.path("uncertain_sampling");
        let names: Vec<String> = uncertain.iter().map(|drawn| drawn.parameter.name()).collect();
        let default = UncertainSamplingFile::default();
        if written.is_some() && names.is_empty() {
            let allowed = "`uncertain` with at least one parameter, or no `uncertain_sampling`";
            return Err(path.wrong_key("nothing is uncertain", "no uncertain parameter", allowed));
        }
        let UncertainSamplingFile { design, correlations } = written.unwrap_or(&default);
        let kind = design.unwrap_or_default();
        let pairs = pairs(&path.key("correlations"), correlations.as_deref(), &names)?;
        let copula = (!pairs.is_empty()).then(|| copula(&path.key("correlations"), &pairs, &names));
        let copula = copula.transpose()?;
        let file = (kind != UncertainDesignKind::MonteCarlo || copula.is_some()).then(|| {
            let correlations = copula.is_some().then(|| to_file(pairs, &names));
            UncertainSamplingFile { design: Some(kind), correlations }
        });
        Ok(UncertainSampling { kind, copula, file, names, seed, path })
    }

    /// Returns the largest number of runs of a point for which the design has different samples.
    pub fn longest(&self) -> u64 {
        match self.kind {
            UncertainDesignKind::Sobol => MAX_SOBOL_SAMPLES,
            _ => u64::MAX,
        }
    }

    /// Returns the design of the uncertain parameters for the runs of a block.
    ///
    /// # Errors
    /// Returns an error if the design cannot be enlarged and there is a precision, if it has too few samples or
    /// dimensions, or if the design of the start states has no further axes.
    pub fn of_block(
        &self,
        design: &Design,
        sampling: Sampling,
        precision: Option<&Precision>,
    ) -> Result<UncertainDesign, StudyError> {
        let latin = |runs| UncertainDesign::latin_hypercube(&self.names, runs, self.seed);
        let refuse = |fault| self.path.key("design").refuse_value(fault);
        let uncertain_design = match (self.kind, &design.layout) {
            (UncertainDesignKind::MonteCarlo, _)
            | (UncertainDesignKind::Joint, Layout::MonteCarlo { .. }) => {
                UncertainDesign::MonteCarlo
            }
            (UncertainDesignKind::LatinHypercube, _) if precision.is_some() => {
                let allowed = "monte_carlo, sobol or joint, or no `precision`";
                let problem = "a design that cannot be enlarged";
                return Err(refuse(Fault::new(
                    problem,
                    "latin_hypercube with `precision`",
                    allowed,
                )));
            }
            (UncertainDesignKind::LatinHypercube, _)
            | (UncertainDesignKind::Joint, Layout::LatinHypercube { .. }) => latin(sampling.first),
            (UncertainDesignKind::Sobol, _) if sampling.first > MAX_SOBOL_SAMPLES => {
                let found = format!("{} runs at each point", sampling.first);
                let allowed = format!(
                    "sobol for at most {MAX_SOBOL_SAMPLES} runs at each point, or latin_hypercube"
                );
                return Err(refuse(Fault::new(
                    "too many runs for a Sobol' sequence",
                    found,
                    allowed,
                )));
            }
            (UncertainDesignKind::Sobol, _) => UncertainDesign::own_sobol(self.seed),
            (UncertainDesignKind::Joint, Layout::Sobol { .. }) => {
                let (seed, first_dimension) = design.further_dimensions();
                UncertainDesign::Sobol { seed, first_dimension }
            }
            (UncertainDesignKind::Joint, _) => {
                let found =
                    format!("joint with the design {} of start states", design.layout.kind());
                let allowed = "latin_hypercube, sobol or monte_carlo for the start states, or \
                               latin_hypercube or sobol here, over all runs of a point";
                let problem = "a design of start states without further axes";
                return Err(refuse(Fault::new(problem, found, allowed)));
            }
        };
        check_dimensions(uncertain_design.dimensions(self.names.len())).map_err(refuse)?;
        Ok(uncertain_design)
    }
}

/// Returns the pairs in the order of the file.
fn pairs(
    path: &SourcePath<'_>,
    written: Option<&[CorrelationFile]>,
    names: &[String],
) -> Result<Vec<CorrelatedPair>, StudyError> {
    let Some(written) = written else { return Ok(Vec::new()) };
    if written.is_empty() {
        let allowed = "at least one pair, or no `correlations`";
        return Err(path.wrong_value("no pair", "an empty list", allowed));
    }
    let mut pairs: Vec<CorrelatedPair> = Vec::with_capacity(written.len());
    for (index, CorrelationFile { parameters, rank_correlation }) in written.iter().enumerate() {
        let path = path.item(index);
        let list = path.key("parameters");
        let two = "two different uncertain parameters, such as [stiffness_n_m, damping_n_s_m]";
        let [left, right] = &parameters[..] else {
            let found = format!("a list of {}", parameters.len());
            return Err(list.wrong_value("wrong number of values", found, two));
        };
        let place = |item: usize, name: &str| {
            find(names, name).map_err(|fault| list.item(item).refuse_value(fault))
        };
        let mut places = [place(0, left)?, place(1, right)?];
        if places[0] == places[1] {
            let found = format!("{left} twice");
            return Err(list.wrong_value("a pair of one parameter", found, two));
        }
        places.sort_unstable();
        if let Some(first) = pairs.iter().position(|pair| pair.places == places) {
            let found = format!("{left} and {right} here and in item {first} of the list");
            return Err(list.wrong_value("a pair given twice", found, "each pair once"));
        }
        pairs.push(CorrelatedPair { places, value: *rank_correlation });
    }
    Ok(pairs)
}

/// Returns the place of the uncertain parameter with this name, which may lack its unit.
fn find(names: &[String], name: &str) -> Result<usize, Fault> {
    let is_short = |known: &String| split_unit(known).is_some_and(|(short, _)| short == name);
    let place =
        names.iter().position(|known| known == name).or_else(|| names.iter().position(is_short));
    place.ok_or_else(|| {
        Fault::new(
            "not an uncertain parameter",
            crate::study::shorten(name),
            list_names(name, names),
        )
    })
}

fn copula(
    path: &SourcePath<'_>,
    pairs: &[CorrelatedPair],
    names: &[String],
) -> Result<Copula, StudyError> {
    let refuse = |Contradiction { pair, place, possible }| {
        let CorrelatedPair { places: [left, right], value } = pairs[pair];
        let name = &names[place];
        let (value, pair_in_words) =
            (describe_number(value), format!("{} and {}", names[left], names[right]));
        let found = format!("{value} for {pair_in_words}, with those of the other pairs of {name}");
        let weaker = format!("weaker correlations of {name}");
        let allowed = match possible {
            Some([low, high]) => format!(
                "{} to {} for this pair, which the other pairs leave possible, or {weaker}",
                describe_number(low),
                describe_number(high)
            ),
            None => weaker,
        };
        let problem = "correlations that contradict one another (not positive definite)";
        path.item(pair).key("rank_correlation").wrong_value(problem, found, allowed)
    };
    Copula::new(names.len(), pairs).map_err(refuse)
}

/// Returns the pairs in the order of the model's parameters.
fn to_file(mut pairs: Vec<CorrelatedPair>, names: &[String]) -> Vec<CorrelationFile> {
    pairs.sort_by_key(|pair| pair.places);
    let written = |pair: CorrelatedPair| CorrelationFile {
        parameters: pair.places.map(|place| names[place].clone()).to_vec(),
        rank_correlation: pair.value,
    };
    pairs.into_iter().map(written).collect()
}
