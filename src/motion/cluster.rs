//! Contacts that touch: which of them move together, and whether friction holds those that stick.

use smallvec::SmallVec;

use super::{Evaluator, Phase};
use crate::model::{Gap, HeldContact, Holding, held};

impl Evaluator {
    /// Returns the sets of contacts that touch, by the gaps that are closed.
    pub(crate) fn clusters(&self, phases: &[Phase]) -> Vec<Vec<usize>> {
        let touching = self.system().touching();
        touching.map_or_else(Vec::new, |touching| clusters(touching.gaps(), phases, |_| true))
    }

    /// Returns the positions, and the sliding speeds, of the contacts that touch another one and move with it, each with that of the
    /// contact that it follows: the contact `leader` if it is among those that touch.
    pub(crate) fn following(
        &self,
        phases: &[Phase],
        leader: Option<usize>,
    ) -> [Vec<(usize, usize)>; 2] {
        let graph = self.graph();
        let position = |contact: usize| graph.layout.contacts[contact].position;
        let [mut positions, mut speeds] = [Vec::new(), Vec::new()];
        for cluster in self.clusters(phases) {
            let first = leader.filter(|contact| cluster.contains(contact)).unwrap_or(cluster[0]);
            for follower in cluster.into_iter().filter(|contact| *contact != first) {
                positions.push((position(follower), position(first)));
                let speed = graph.speed_component(follower);
                speeds.extend(speed.zip(graph.speed_component(first)));
            }
        }
        [positions, speeds]
    }

    /// Returns the smallest friction margin of some contacts that stick: the reserve of friction over the friction limit.
    pub(crate) fn friction_margin(
        &self,
        phases: &[Phase],
        state: &[f64],
        contacts: &[usize],
    ) -> f64 {
        let forces = self.forces(phases, state);
        let limit = |contact: usize| self.system().friction(contact).limit;
        let force_pair = |contact: usize| [forces[contact].normal, forces[contact].friction];
        let touching = self.system().touching();
        let held = touching.map_or_else(Vec::new, |between| held_clusters(between.gaps(), phases));
        let margin = |contact: usize| {
            let [normal, friction] = force_pair(contact);
            let most = limit(contact) * normal;
            match held.iter().find(|cluster| cluster.contacts.contains(&contact)) {
                None => 1.0 - friction.abs() / most,
                Some(cluster) => cluster.holding(limit, force_pair).reserve / most,
            }
        };
        contacts.iter().map(|contact| margin(*contact)).fold(f64::INFINITY, f64::min)
    }
}

/// Returns the sets of contacts that stick and touch.
pub(super) fn held_clusters(all: &[Gap], phases: &[Phase]) -> Vec<HeldCluster> {
    let sticks = |contact: usize| phases[contact] == Phase::Stick;
    let with_gaps = |contacts: Vec<usize>| {
        let gaps = all.iter().zip(&phases[phases.len() - all.len()..]);
        let gaps = gaps.filter(|(_, phase)| **phase == Phase::Closed).filter_map(|(gap, _)| {
            let place = |side: usize| contacts.iter().position(|contact| *contact == side);
            let [behind, ahead] = gap.contacts;
            Some(Gap { contacts: [place(behind)?, place(ahead)?], ..*gap })
        });
        HeldCluster { gaps: gaps.collect(), contacts }
    };
    clusters(all, phases, sticks).into_iter().map(with_gaps).collect()
}

/// Returns the sets of contacts that closed gaps connect, of those contacts that `which` accepts.
fn clusters(gaps: &[Gap], phases: &[Phase], which: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
    let contacts = phases.len() - gaps.len();
    let mut root: SmallVec<[usize; 8]> = (0..contacts).collect();
    for (gap, phase) in gaps.iter().zip(&phases[contacts..]) {
        let [behind, ahead] = gap.contacts;
        if *phase == Phase::Closed && which(behind) && which(ahead) {
            let (from, to) = (root[ahead], root[behind]);
            root.iter_mut().filter(|root| **root == from).for_each(|root| *root = to);
        }
    }
    let members = |of: usize| (0..contacts).filter(|index| root[*index] == of).collect::<Vec<_>>();
    (0..contacts).map(members).filter(|cluster| cluster.len() > 1).collect()
}

/// Contacts that stick and touch each other.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HeldCluster {
    pub(super) contacts: Vec<usize>,
    /// The closed gaps between them, which count the contacts of the cluster.
    pub(super) gaps: Vec<Gap>,
}

impl HeldCluster {
    /// Returns the contacts with their normal and friction forces.
    pub(super) fn held_contacts(
        &self,
        limit: impl Fn(usize) -> f64,
        forces: impl Fn(usize) -> [f64; 2],
    ) -> Vec<HeldContact> {
        let contact = |contact: &usize| {
            let [normal, friction] = forces(*contact);
            HeldContact { normal, friction, limit: limit(*contact), weight: 1.0 }
        };
        self.contacts.iter().map(contact).collect()
    }

    /// Returns the forces that hold the contacts.
    pub(super) fn holding(
        &self,
        limit: impl Fn(usize) -> f64,
        forces: impl Fn(usize) -> [f64; 2],
    ) -> Holding {
        held(&self.held_contacts(limit, forces), &self.gaps)
    }
}
