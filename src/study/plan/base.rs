//! The model of a study before any parameter is swept or drawn, and which of its parameters may vary.

use crate::model::{Ball, Model, ParameterDescriptor};
use crate::study::error::Fault;
use crate::study::file::model_parts::BallFile;
use crate::study::plan::parameter::{Parameter, ParameterValue};

/// The model before any parameter is swept or drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Base {
    /// The model.
    pub model: Model,
    /// Default values of the balls.
    pub general: Ball,
    /// The own values of each ball; the study file has this number of balls.
    pub each_ball: Vec<BallFile>,
    /// The smallest number of balls of a point; the model has the largest.
    pub fewest_balls: usize,
    /// The kicks whose direction is drawn, counted from 1.
    pub random_kicks: Vec<usize>,
}

impl Base {
    /// Returns the base for a sweep over numbers of balls, from the smallest to the largest one.
    pub fn with_balls(&self, [fewest, most]: [usize; 2]) -> Base {
        let mut base = Base { fewest_balls: fewest, ..self.clone() };
        if let Some(machine) = base.model.ball_balancer_mut() {
            machine.balls.resize(most, self.general);
        }
        base
    }

    /// Returns the number of balls in the study file; 0 for a model without balls.
    pub fn balls(&self) -> usize {
        self.each_ball.len()
    }

    /// Returns the value of a parameter before it is swept or drawn.
    pub fn value(&self, parameter: Parameter) -> ParameterValue {
        if parameter == Parameter::BALLS {
            return ParameterValue::Number(self.balls() as f64);
        }
        parameter.get(&self.model, &self.general)
    }

    /// Checks whether the number of balls may vary.
    ///
    /// # Errors
    /// Returns a fault if balls have their own values.
    pub fn check_number_varies(&self) -> Result<(), Fault> {
        if !self.has_own() {
            return Ok(());
        }
        let allowed = "a number under `model.parameters.balls`";
        Err(Fault::new("balls have their own values", "a list of balls", allowed))
    }

    /// Checks whether a parameter may vary. A value of all balls may not vary if one ball has its
    /// own value, which would be ambiguous. A parameter that the friction law does not use may not
    /// vary either, nor a value of a ball that some points do not have.
    ///
    /// # Errors
    /// Returns a fault that names the parameters to vary instead.
    pub fn check_varied(&self, parameter: Parameter) -> Result<(), Fault> {
        if parameter.is_unused(&self.model) {
            let law = self.model.friction();
            let names =
                law.law().parameters().iter().map(|key| key.name(self.model.kind().sliding_speed));
            let names: Vec<String> = names.map(|name| format!("{name}, ")).collect();
            let allowed = format!("{}or another friction law", names.concat());
            let problem = format!("{} friction does not use it", law.name());
            return Err(Fault::new(problem, parameter.name(), allowed));
        }
        if let Some(ball) = parameter.ball().filter(|ball| *ball > self.fewest_balls) {
            let found = format!("{}, while some points have no ball {ball}", parameter.name());
            let allowed = match self.fewest_balls {
                1 => "a parameter of ball 1, which every point has".to_owned(),
                fewest => format!("a parameter of a ball that every point has, 1 to {fewest}"),
            };
            return Err(Fault::new("some points do not have this ball", found, allowed));
        }
        if !(parameter.is_general() && parameter.is_of_balls()) {
            return Ok(());
        }
        let name = parameter.name();
        let has_value = |ball: &BallFile| ball.value(&name).is_some();
        match self.each_ball.iter().position(has_value) {
            None => Ok(()),
            Some(index) => {
                let found = format!("{name}, while ball {} has its own value", index + 1);
                let name_of = |ball| parameter.of_one_member(ball).name();
                let allowed: Vec<String> = (1..=self.each_ball.len()).map(name_of).collect();
                let problem = "a ball has its own value";
                Err(Fault::new(problem, found, allowed.join(", ")))
            }
        }
    }

    /// Returns whether any ball has its own values.
    pub fn has_own(&self) -> bool {
        self.each_ball.iter().any(|ball| *ball != BallFile::default())
    }

    /// Returns whether the study gives a ball its own value of this parameter of one ball.
    pub fn has_own_value(&self, parameter: Parameter) -> bool {
        let Some(general) = parameter.general().filter(|general| general.is_of_balls()) else {
            return false;
        };
        let mut balls = (1..).zip(&self.each_ball);
        balls.any(|(number, ball)| {
            general.of_one_member(number) == parameter && ball.value(&general.name()).is_some()
        })
    }

    /// Returns whether every ball has its own value of this parameter of all balls, which is then not used.
    pub fn has_only_own_values(&self, general: Parameter) -> bool {
        let name = general.name();
        general.is_general()
            && general.is_of_balls()
            && self.each_ball.iter().all(|ball| ball.value(&name).is_some())
    }

    /// Returns the whole numbers of the model, such as a number of bodies, with their names.
    pub fn counts(&self) -> impl Iterator<Item = (&'static str, f64)> {
        let counts = self.model.kind().parameters.iter();
        let counts = counts.filter(|parameter| parameter.largest_count().is_some());
        let value = |entry: &'static ParameterDescriptor| {
            let number = entry.numbers(&mut self.model.clone(), None).first().map(|first| **first);
            Some((entry.name, number?))
        };
        counts.filter_map(value)
    }
}
