//! The values of the names in an instance, and its mass matrix and forces with these values.

use super::formula::Valued;
use super::given_terms::GivenTerms;
use super::instance::{Instance, Member};
use super::numeric::{NamedValues, Scalar, Scales};

/// The values of names of an instance.
pub(super) type Coordinates<'a, T> = Vec<(&'a str, Option<i64>, [T; 3])>;

impl Instance<'_> {
    /// Returns the coordinates by name, with their values and rates of change, and accelerations of 0.
    pub fn named<T: Scalar>(&self, values: impl Fn(usize) -> [T; 2]) -> Coordinates<'_, T> {
        let members = self.coordinates.iter().enumerate();
        let named = |(number, member): (usize, &Member)| {
            let [position, rate] = values(number);
            let name = self.definition.coordinates[member.of].name.as_str();
            (name, member.body, [position, rate, T::constant(0.0)])
        };
        members.map(named).collect()
    }

    /// Returns the parameters by name, the angle that turns at constant speed at a time, and the last values of given motions; all
    /// have the units of `scales`.
    pub fn parameters<T: Scalar>(
        &self,
        values: &[T],
        scales: Scales,
        time: T,
    ) -> Vec<(&str, usize, T)> {
        let at_rest = GivenTerms::at_rest(self.definition, scales).map(T::constant);
        self.parameters_in_stage(values, &at_rest, time)
    }

    /// Returns the parameters by name, and the angle that turns and the given motions with their rates of change at a time since
    /// the begin of a stage.
    pub fn parameters_in_stage<T: Scalar>(
        &self,
        values: &[T],
        stage: &GivenTerms<T>,
        time: T,
    ) -> Vec<(&str, usize, T)> {
        let names = self.definition.parameters.iter().map(|parameter| parameter.name.as_str());
        let parameters = names.zip(values).map(|(name, value)| (name, 0, *value));
        let angle = self.definition.turning.iter().map(|turning| turning.angle.as_str());
        let motions = self.definition.motions.iter().map(|motion| motion.name.as_str());
        let speed = self.definition.speed_place().map(|place| values[place]);
        let turned = stage.turned_at(speed, time);
        let moving = angle.zip(turned).chain(motions.zip(stage.given_at(time)));
        let moving = moving.flat_map(|(name, values)| {
            (0..).zip(values).map(move |(primes, value)| (name, primes, value))
        });
        parameters.chain(moving).collect()
    }

    /// Returns the mass matrix, and the forces.
    pub fn mass_and_forces<T: Scalar>(
        &self,
        values: &mut NamedValues<'_, T>,
    ) -> Valued<(Vec<Vec<T>>, Vec<T>)> {
        let (n, zero) = (self.coordinates.len(), T::constant(0.0));
        let (mut mass, mut forces) = (vec![vec![zero; n]; n], vec![zero; n]);
        for ([row, column], formula) in &self.definition.mass {
            for ([row, column], mut bodies) in
                self.places([row, column]).map_err(|(_, fault)| fault)?
            {
                let entry = bodies.evaluate(formula, values)?;
                mass[row][column] = entry;
                mass[column][row] = entry;
            }
        }
        for (place, formula) in &self.definition.force {
            for ([number], mut bodies) in self.places([place]).map_err(|(_, fault)| fault)? {
                forces[number] = forces[number] + bodies.evaluate(formula, values)?;
            }
        }
        Ok((mass, forces))
    }
}
