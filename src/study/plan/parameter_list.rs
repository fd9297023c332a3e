//! The parameters of a study's model, with the origin of each value: the file, a default, the sweep, a distribution
//! or a design.

use crate::study::plan::parameter::{Parameter, ParameterValue};
use crate::study::plan::planned_study::Study;
use crate::study::plan::sweep::Block;
use crate::study::plan::variable::Domain;

/// A parameter of the model and the origin of its values.
#[derive(Clone, Debug, PartialEq)]
pub struct ListedParameter {
    /// Name, as in the study file.
    pub name: String,
    /// Unit; `1` for dimensionless numbers, empty for words.
    pub unit: &'static str,
    /// The value before the sweep, the design and a random factor set another one. The median of the distribution if
    /// the whole value is uncertain.
    pub value: ParameterValue,
    /// Whether the study does not give this value, so that it is the default.
    pub is_default: bool,
    /// The values at the points of the sweep.
    pub swept: Option<SweptValues>,
    /// The range of the draws.
    pub uncertain: Option<UncertainRange>,
    /// The smallest and the largest value of a design.
    pub design: Option<[f64; 2]>,
}

/// The values of a swept parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct SweptValues {
    /// Number of different values at all points.
    pub count: usize,
    /// The smallest and the largest number; `None` for words.
    pub range: Option<[f64; 2]>,
    /// Whether `model.parameters` gives another value, which no point has.
    pub overrides: bool,
}

/// The draws of an uncertain parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UncertainRange {
    /// The quantiles of the fractions 0.025 and 0.975, of the value or of the factor.
    pub range: [f64; 2],
    /// Whether the draw is a factor that multiplies the value.
    pub factor: bool,
    /// The value of `model.parameters`, if it differs from the median and no run has it.
    pub overridden: Option<ParameterValue>,
}

impl ListedParameter {
    /// Returns whether the sweep, a distribution or a design sets the value, so that the default has no effect.
    pub fn is_varied(&self) -> bool {
        self.swept.is_some()
            || self.design.is_some()
            || self.uncertain.is_some_and(|range| !range.factor)
    }
}

impl Study {
    /// Returns the parameters of the model, in the order of the documentation. A ball has its own entry if it has its
    /// own value.
    pub fn parameters(&self) -> Vec<ListedParameter> {
        let all = Parameter::all(&self.base.model).into_iter();
        let mut list: Vec<ListedParameter> =
            all.filter(|parameter| self.lists(*parameter)).map(|kept| self.listed(kept)).collect();
        let before = |list: &[ListedParameter], first: &dyn Fn(&str) -> bool| {
            list.iter().position(|listed| first(&listed.name)).unwrap_or(list.len())
        };
        if self.base.model.ball_balancer().is_some() {
            let place = before(&list, &|name| name.starts_with("ball_"));
            list.insert(place, self.number_of_balls());
        }
        let count = |(name, count)| self.fixed(name, "1", ParameterValue::Number(count));
        list.splice(0..0, self.base.counts().map(count));
        let of_law: Vec<String> = Parameter::all(&self.base.model)
            .into_iter()
            .filter(|parameter| parameter.is_of_law())
            .map(Parameter::name)
            .collect();
        let of_friction =
            |name: &str| name.starts_with("friction_") || of_law.iter().any(|known| known == name);
        let place = before(&list, &of_friction);
        if self.model().kind().has_law_of_study() {
            let law = ParameterValue::Text(self.base.model.friction().name());
            list.insert(place, self.fixed("friction", "", law));
        }
        if self.base.model.ball_balancer().is_some_and(|machine| machine.contact.is_none()) {
            list.push(self.fixed("contact", "", ParameterValue::Text("none")));
        }
        list
    }

    fn lists(&self, parameter: Parameter) -> bool {
        if parameter.is_unused(&self.base.model)
            || self.determined.contains(&parameter.general_name())
        {
            return false;
        }
        if parameter.determines_another() && !parameter.is_given(&self.base.model) {
            return self.varies(parameter);
        }
        match parameter.general() {
            // Each ramp, plateau and kick has its own values.
            Some(general) if !general.is_of_balls() => true,
            None if parameter.is_general() && !parameter.is_of_balls() => self.varies(parameter),
            Some(_) => self.base.has_own_value(parameter) || self.varies(parameter),
            None => !self.base.has_only_own_values(parameter) || self.varies(parameter),
        }
    }

    fn varies(&self, parameter: Parameter) -> bool {
        self.swept_parameters.contains(&parameter)
            || self.uncertain_parameters.iter().any(|drawn| drawn.parameter == parameter)
            || self.design_range(parameter).is_some()
    }

    fn listed(&self, parameter: Parameter) -> ListedParameter {
        let base = parameter.get(&self.base.model, &self.base.general);
        let drawn = self.uncertain_parameters.iter().find(|draw| draw.parameter == parameter);
        let value = match drawn {
            Some(draw) if !draw.factor => ParameterValue::Number(draw.distribution.quantile(0.5)),
            _ => base,
        };
        let name = parameter.name();
        let is_given = match parameter.general() {
            Some(general) => self.base.has_own_value(parameter) || self.gives(&general.name()),
            None => self.gives(&name),
        };
        // The parameters of a law, a speed profile and a kick have no defaults.
        let is_given = is_given || parameter.is_of_law() || parameter.is_of_stages();
        ListedParameter {
            unit: parameter.unit(),
            value,
            is_default: !is_given,
            swept: self.swept_values(parameter),
            uncertain: drawn.map(|draw| UncertainRange {
                range: [0.025, 0.975].map(|fraction| draw.distribution.quantile(fraction)),
                factor: draw.factor,
                overridden: Some(base).filter(|base| self.gives(&name) && !is_same(*base, value)),
            }),
            design: self.design_range(parameter),
            name,
        }
    }

    /// Returns the entry of a value that nothing varies.
    fn fixed(&self, name: &str, unit: &'static str, value: ParameterValue) -> ListedParameter {
        ListedParameter {
            name: name.to_owned(),
            unit,
            value,
            is_default: !self.gives(name),
            swept: None,
            uncertain: None,
            design: None,
        }
    }

    fn number_of_balls(&self) -> ListedParameter {
        let numbers = self.variables().iter().find_map(|variable| variable.ball_numbers());
        ListedParameter {
            swept: self.swept_values(Parameter::BALLS),
            design: numbers.map(|numbers| [*numbers.start() as f64, *numbers.end() as f64]),
            ..self.fixed("balls", "1", self.base.value(Parameter::BALLS))
        }
    }

    fn swept_values(&self, parameter: Parameter) -> Option<SweptValues> {
        if !self.swept_parameters.contains(&parameter) {
            return None;
        }
        // A block that does not sweep the parameter has its base value.
        let base = self.base.value(parameter);
        let of_block =
            |block: &Block| block.list(parameter).map_or_else(|| vec![base], <[_]>::to_vec);
        let (mut numbers, mut texts) = (Vec::new(), Vec::new());
        for value in self.blocks.iter().flat_map(of_block) {
            match value {
                ParameterValue::Number(number) => numbers.push(number),
                ParameterValue::Text(text) => texts.push(text),
            }
        }
        numbers.sort_by(f64::total_cmp);
        numbers.dedup();
        texts.sort_unstable();
        texts.dedup();
        let count = numbers.len() + texts.len();
        let has_base = numbers.iter().any(|number| is_same(base, ParameterValue::Number(*number)))
            || texts.iter().any(|text| is_same(base, ParameterValue::Text(text)));
        let overrides = self.gives(&parameter.name()) && !has_base;
        Some(SweptValues { count, range: range(numbers.into_iter()), overrides })
    }

    /// Returns the smallest and the largest value that a design may set.
    fn design_range(&self, parameter: Parameter) -> Option<[f64; 2]> {
        range(self.variables().iter().flat_map(|variable| match &variable.domain {
            Domain::Parameter { parameter: set, from, to } if *set == parameter => vec![*from, *to],
            Domain::Choices(choices) => {
                let all = choices.iter().flat_map(|(_, values)| values);
                all.filter(|(set, _)| *set == parameter).map(|(_, value)| *value).collect()
            }
            _ => Vec::new(),
        }))
    }

    /// Returns the key that sets a parameter at a point, such as `sweep[0].grid.speed_rad_s`. `ball`, from 1, selects
    /// a ball for a parameter of balls. The key is that of `model.parameters` if nothing sets the parameter.
    pub fn key_of(&self, general: &str, ball: Option<usize>, point_id: u64) -> String {
        if self.determined.contains(&general) {
            let parameters = self.base.model.kind().parameters.iter();
            let mut given = parameters.filter(|parameter| parameter.determines() == Some(general));
            if let Some(parameter) = given.next() {
                return self.key_of(parameter.name, ball, point_id);
            }
        }
        let of_all = Parameter::find(general, &self.base.model);
        let of_ball = ball.and_then(|ball| Some(of_all?.of_one_member(ball).name()));
        let names: Vec<&str> = of_ball.as_deref().into_iter().chain([general]).collect();
        let index = self.block_of(point_id);
        let block = &self.blocks[index];
        for name in &names {
            if block.columns.iter().any(|(parameter, _)| parameter.name() == *name) {
                return block.listing.path_of(&format!("sweep[{index}]"), name);
            }
            if let Some(variable) = self.variables().iter().find(|variable| variable.sets(name)) {
                return format!("design.{}", variable.name());
            }
            if self.uncertain.iter().any(|column| column.name == *name) {
                return format!("uncertain.{name}");
            }
        }
        if let Some(index) = ball.and_then(|ball| ball.checked_sub(1)) {
            let name = general.strip_prefix("ball_").unwrap_or(general);
            let key = format!("model.parameters.balls[{index}].{name}");
            if self.has_key(&key) {
                return key;
            }
        }
        let law = format!("model.friction.{}.{general}", self.base.model.friction().name());
        if self.has_key(&law) { law } else { format!("model.parameters.{general}") }
    }
}

/// The fraction by which a swept value may differ from the one in `model.parameters` that it repeats, such as `628.3` for
/// `6000 rpm`.
const SAME: f64 = 1e-3;

fn is_same(base: ParameterValue, other: ParameterValue) -> bool {
    match (base, other) {
        (ParameterValue::Number(base), ParameterValue::Number(other)) => {
            (other - base).abs() <= SAME * base.abs()
        }
        (base, other) => base == other,
    }
}

/// Returns the smallest and the largest number, if there are any.
fn range(numbers: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    numbers.fold(None, |range, number| {
        let [low, high] = range.unwrap_or([number; 2]);
        Some([f64::min(low, number), f64::max(high, number)])
    })
}
