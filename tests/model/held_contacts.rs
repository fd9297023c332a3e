//! Forces between contacts that stick and touch, against closed forms and a scan of all forces.

use stickslip::model::{Gap, HeldContact, held, least_force};

/// A contact with this normal force and required friction.
fn contact(normal: f64, friction: f64, limit: f64) -> HeldContact {
    HeldContact { normal, friction, limit, weight: 1.0 }
}

/// Two equal balls that press against each other: the force takes `λ/m` off the required friction, and adds `μ tan(Δ/2) λ/m`
/// to the limit.
#[test]
fn two_balls_lean_on_each_other() {
    let (mass, angle, limit) = (4e-4, 0.2616, 2.75e-3);
    let tangent = f64::tan(0.5 * angle);
    let gap = Gap::between_balls([0, 1], angle, [mass; 2], 0.0);
    for needed in [1e-3, 2e-3, 1e-2, 0.3] {
        for normal in [0.7, 1.0] {
            let contacts = [contact(normal, needed, limit), contact(normal, -needed, limit)];
            let alone = limit * normal - needed;
            let least = (-alone).max(0.0) * mass / (1.0 + limit * tangent);
            let force = least_force(&contacts, &[gap]).unwrap();
            assert!((force - least).abs() <= 1e-8 * least, "{force} {least}");
            // With the largest reserve, the force takes off all of the required friction.
            let reserve = limit * (normal + tangent * needed);
            let holding = held(&contacts, &[gap]);
            assert!((holding.reserve - reserve).abs() < 1e-12, "{} {reserve}", holding.reserve);
        }
    }
    // The contact can only press.
    let apart = [contact(1.0, -0.1, limit), contact(1.0, 0.1, limit)];
    assert_eq!(least_force(&apart, &[gap]), None);
    assert!((held(&apart, &[gap]).reserve - (limit - 0.1)).abs() < 1e-15);
}

/// Three balls in a row: of all forces and frictions between them on a grid, none gives a larger reserve than the linear
/// programme, and the best ones nearly the same.
#[test]
fn no_forces_on_a_grid_are_better() {
    let (masses, limits) = ([1.0, 0.6, 1.4], [0.3, 0.2, 0.25]);
    let gaps = [(0, 0.3, 0.15), (1, 0.35, 0.4)].map(|(first, angle, friction)| {
        let [behind, ahead] = [masses[first], masses[first + 1]];
        Gap::between_balls([first, first + 1], angle, [behind, ahead], friction)
    });
    let needs = [[0.5, 0.1, -0.4], [0.2, 0.3, -0.1], [-0.3, -0.2, -0.1], [0.1, 0.4, -0.6]];
    for needed in needs {
        let contacts: [HeldContact; 3] =
            std::array::from_fn(|i| contact(1.0 - 0.1 * i as f64, needed[i], limits[i]));
        let reserve = |forces: [[f64; 2]; 2]| {
            let mut sums = contacts.map(|contact| [contact.friction, contact.normal]);
            for (gap, forces) in gaps.iter().zip(forces) {
                for (pushes, force) in gap.pushes().into_iter().zip(forces) {
                    for (ball, push) in gap.contacts.into_iter().zip(pushes) {
                        sums[ball][0] += push[0] * force;
                        sums[ball][1] += push[1] * force;
                    }
                }
            }
            let each = sums.iter().zip(limits).map(|([t, f], limit)| limit * f - t.abs());
            each.fold(f64::INFINITY, f64::min)
        };
        let best = held(&contacts, &gaps).reserve;
        let (steps, most) = (40, 1.2);
        let mut found = f64::NEG_INFINITY;
        let forces = |gap: &Gap, index: i32| {
            let force = f64::from(index / 9) / f64::from(steps) * most;
            [force, gap.friction_coefficient * force * (f64::from(index % 9) / 4.0 - 1.0)]
        };
        for first in 0..9 * steps {
            for second in 0..9 * steps {
                found = found.max(reserve([forces(&gaps[0], first), forces(&gaps[1], second)]));
            }
        }
        assert!(found <= best + 1e-12, "{found} {best}");
        assert!(found > best - 0.05, "{found} {best} {needed:?}");
    }
}
