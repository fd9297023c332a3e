//! Uniqueness of the stick-slip decision: the closed form against determinants, search and brute
//! force.

use nalgebra::{DMatrix, DVector};
use stickslip::model::{Balancer, Ball, ExistenceVerdict, Machine, SAFE_FRICTION};

use crate::support::TestRng;

/// A machine with heavy balls, a light table and friction coefficients up to `most_friction`.
fn extreme(draws: &mut TestRng, balls: usize, most_friction: f64) -> Machine {
    let mut ball = || Ball {
        mass_kg: 0.05 + draws.uniform(),
        diameter_m: 3e-3,
        friction_coefficient: most_friction * draws.uniform(),
        ..Ball::default()
    };
    let balls = (0..balls).map(|_| ball()).collect();
    let table_mass_kg = 1e-3 + 0.3 * draws.uniform() * draws.uniform();
    Machine { balls, table_mass_kg, ..Machine::default() }
}

fn positions<const N: usize>(draws: &mut TestRng) -> [f64; N] {
    std::array::from_fn(|_| 7.0 * draws.uniform())
}

/// Returns the response of the forces to accelerations, from the equations of motion: `f_w = q - A
/// β̈`, `f_n = n + B β̈`.
fn answers<const N: usize>(
    balancer: &Balancer<N>,
    beta: &[f64; N],
) -> (DMatrix<f64>, DMatrix<f64>) {
    let mass = |j: usize| balancer.balls[j].mass;
    let a = DMatrix::from_fn(N, N, |i, j| {
        let inertia = if i == j { 1.0 + 4.0 * balancer.balls[i].inertia } else { 0.0 };
        inertia - mass(j) * (beta[i] - beta[j]).cos()
    });
    (a, DMatrix::from_fn(N, N, |i, j| mass(j) * (beta[i] - beta[j]).sin()))
}

/// A set of balls and the directions in which friction is at its limit.
type Corner = Vec<(usize, f64)>;

/// All sets of balls with all directions.
fn corners(balls: usize) -> Vec<Corner> {
    let digits = |mut combination: usize| {
        let mut corner = Vec::new();
        for ball in 0..balls {
            match combination % 3 {
                1 => corner.push((ball, 1.0)),
                2 => corner.push((ball, -1.0)),
                _ => {}
            }
            combination /= 3;
        }
        corner
    };
    (1..3_usize.pow(balls as u32)).map(digits).collect()
}

/// The principal submatrix of `K` that belongs to a corner.
fn submatrix<const N: usize>(
    balancer: &Balancer<N>,
    (a, b): &(DMatrix<f64>, DMatrix<f64>),
    corner: &Corner,
) -> DMatrix<f64> {
    DMatrix::from_fn(corner.len(), corner.len(), |row, column| {
        let ((i, direction), (j, _)) = (corner[row], corner[column]);
        a[(i, j)] + direction * balancer.balls[i].friction.limit * b[(i, j)]
    })
}

/// The corner with the least normalised principal minor, by determinants.
fn least_corner<const N: usize>(balancer: &Balancer<N>, beta: &[f64; N]) -> (f64, Corner) {
    let answers = answers(balancer, beta);
    let minor = |corner: Corner| {
        let matrix = submatrix(balancer, &answers, &corner);
        (matrix.determinant() / matrix.diagonal().product(), corner)
    };
    let all = corners(N).into_iter().map(minor);
    all.min_by(|a, b| a.0.total_cmp(&b.0)).expect("several positions")
}

/// Returns all solutions of the decision for given `q` and `n`, in which a ball without normal
/// force is free of friction: the distinct accelerations, and whether all contacts are closed.
fn solutions<const N: usize>(
    balancer: &Balancer<N>,
    (a, b): &(DMatrix<f64>, DMatrix<f64>),
    (q, n): (&DVector<f64>, &DVector<f64>),
) -> Vec<(DVector<f64>, bool)> {
    let slack = 1e-9 * (1.0 + q.amax() + n.amax());
    let mut found: Vec<(DVector<f64>, bool)> = Vec::new();
    for combination in 0..4_u32.pow(N as u32) {
        let kind = |i: usize| combination / 4_u32.pow(i as u32) % 4; // stick, +, -, not pressed
        let ratio =
            |i: usize| [0.0, 1.0, -1.0, 0.0][kind(i) as usize] * balancer.balls[i].friction.limit;
        let mut matrix = DMatrix::identity(N, N);
        let mut right = DVector::zeros(N);
        for i in (0..N).filter(|&i| kind(i) > 0) {
            for j in 0..N {
                matrix[(i, j)] = a[(i, j)] + ratio(i) * b[(i, j)];
            }
            right[i] = q[i] - ratio(i) * n[i];
        }
        let Some(acceleration) = matrix.lu().solve(&right) else { continue };
        let (friction, normal) = (q - a * &acceleration, n + b * &acceleration);
        let fits = |i: usize| match kind(i) {
            0 => friction[i].abs() <= balancer.balls[i].friction.limit * normal[i].max(0.0) + slack,
            1 => acceleration[i] >= -slack && normal[i] >= -slack,
            2 => acceleration[i] <= slack && normal[i] >= -slack,
            _ => normal[i] <= slack,
        };
        let new = |(other, _): &(DVector<f64>, bool)| {
            (other - &acceleration).amax() > 1e-5 * (1.0 + acceleration.amax())
        };
        if (0..N).all(fits) && found.iter().all(new) {
            found.push((acceleration, normal.iter().all(|&normal| normal > 0.0)));
        }
    }
    found
}

fn closed_form_is_the_determinant<const N: usize>(draws: &mut TestRng) {
    for _ in 0..300 {
        let balancer = Balancer::<N>::new(&extreme(draws, N, 5.0)).unwrap();
        let beta = positions(draws);
        let (least, _) = least_corner(&balancer, &beta);
        let closed = balancer.least_minor_at(&beta);
        assert!((least - closed).abs() < 1e-11 * (1.0 + least.abs()), "{least} {closed}");
    }
}

/// The 2×2 form of the minors agrees with determinants of `K` itself.
#[test]
fn closed_form_of_the_minors() {
    let mut draws = TestRng::new(7);
    closed_form_is_the_determinant::<1>(&mut draws);
    closed_form_is_the_determinant::<2>(&mut draws);
    closed_form_is_the_determinant::<3>(&mut draws);
    closed_form_is_the_determinant::<5>(&mut draws);
}

/// If all minors are positive there is exactly one solution for any forces; if one is not, there
/// are forces with several solutions, by construction.
fn one_solution_where_minors_are_positive<const N: usize>(draws: &mut TestRng) -> [u32; 2] {
    let mut seen = [0; 2];
    for _ in 0..400 {
        let balancer = Balancer::<N>::new(&extreme(draws, N, 5.0)).unwrap();
        let beta = positions(draws);
        let answers = answers(&balancer, &beta);
        let (least, corner) = least_corner(&balancer, &beta);
        if least.abs() < 0.02 {
            continue; // nearly singular cases need more digits than brute force has
        }
        let unique = balancer.one_solution_at(&beta);
        assert_eq!(unique, least > 0.0);
        seen[usize::from(unique)] += 1;
        if unique {
            for _ in 0..20 {
                let q = DVector::from_fn(N, |_, _| 20.0 * draws.uniform() - 10.0);
                let n = DVector::from_fn(N, |_, _| 5.0 * draws.uniform() - 1.0);
                let found = solutions(&balancer, &answers, (&q, &n));
                assert_eq!(found.len(), 1, "{found:?}");
            }
            continue;
        }
        // An eigenvector d with a negative eigenvalue has d_i (K d)_i < 0 for every ball of the
        // corner; d⁺ and d⁻, in the corner's directions, solve the problem for the same forces.
        let matrix = submatrix(&balancer, &answers, &corner);
        let eigenvalues = matrix.complex_eigenvalues();
        let eigenvalue = eigenvalues.iter().filter(|z| z.im.abs() < 1e-9 && z.re < 0.0);
        let eigenvalue = eigenvalue.map(|z| z.re).next().expect("det K < 0");
        let size = corner.len();
        let shifted = &matrix - DMatrix::identity(size, size) * eigenvalue;
        let svd = shifted.svd(false, true);
        let least = svd.singular_values.imin();
        let directions = DVector::from_iterator(size, corner.iter().map(|(_, sign)| *sign));
        let d = svd.v_t.unwrap().row(least).transpose().component_mul(&directions);
        let turned =
            DMatrix::from_diagonal(&directions) * &matrix * DMatrix::from_diagonal(&directions);
        let forwards = d.map(|x| x.max(0.0));
        let reserve = (&turned * &d).map(|x| x.max(0.0)) - &turned * &forwards;
        let n = DVector::from_element(N, 1000.0);
        let mut q = DVector::zeros(N);
        for (row, &(ball, direction)) in corner.iter().enumerate() {
            let limit = balancer.balls[ball].friction.limit * n[ball];
            q[ball] = direction * (limit - reserve[row]);
        }
        let found = solutions(&balancer, &answers, (&q, &n));
        let closed = found.iter().filter(|(_, closed)| *closed).count();
        assert!(closed >= 2, "{found:?}");
    }
    seen
}

#[test]
fn brute_force_finds_one_solution_exactly_where_minors_are_positive() {
    let mut draws = TestRng::new(11);
    let two = one_solution_where_minors_are_positive::<2>(&mut draws);
    let three = one_solution_where_minors_are_positive::<3>(&mut draws);
    assert!(two.into_iter().chain(three).all(|count| count > 30), "{two:?} {three:?}");
}

/// The closed form of the worst position of two balls agrees with a scan of all positions.
#[test]
fn worst_position_of_two_balls() {
    let mut draws = TestRng::new(3);
    for _ in 0..50 {
        let machine = extreme(&mut draws, 2, 5.0);
        let balancer = Balancer::<2>::new(&machine).unwrap();
        let verdict = machine.existence();
        let at = |i: i32| balancer.least_minor_at(&[1.0, 1.0 + 1e-3 * f64::from(i)]);
        let scanned = (0..6284).map(at).fold(f64::INFINITY, f64::min);
        let difference = scanned - verdict.least_minor();
        assert!((-1e-12..1e-4).contains(&difference), "{difference:e} {verdict:?}");
    }
}

/// For more balls, no random position is worse than the named one, whose minor is as stated.
#[test]
fn worst_position_of_more_balls() {
    let (mut draws, mut failing) = (TestRng::new(5), 0);
    for _ in 0..200 {
        let machine = extreme(&mut draws, 4, 5.0);
        let balancer = Balancer::<4>::new(&machine).unwrap();
        let verdict = machine.existence();
        for _ in 0..50 {
            let beta = positions(&mut draws);
            assert!(balancer.least_minor_at(&beta) > verdict.least_minor() - 1e-12);
        }
        if let ExistenceVerdict::NotUnique { least_minor, position } = &verdict {
            failing += 1;
            let mut beta = positions(&mut draws);
            for (ball, angle) in position {
                beta[ball - 1] = 2.0 + angle;
            }
            assert!((balancer.least_minor_at(&beta) - least_minor).abs() < 1e-12);
            assert!(!balancer.one_solution_at(&beta) && !balancer.surely_one_solution());
        }
    }
    assert!((50..=200).contains(&failing), "{failing}");
}

/// The thesis's machine satisfies the condition with a wide margin, which answers the question of
/// its section 4.3.
#[test]
fn the_thesis_machine_has_one_solution() {
    let machine = Machine::default();
    let ExistenceVerdict::Unique { least_minor } = machine.existence() else {
        panic!("{:?}", machine.existence())
    };
    assert!(least_minor < 1.0 && 1.0 - least_minor < 1e-7, "{least_minor}");
    assert!(Balancer::<2>::new(&machine).unwrap().surely_one_solution());
    assert_eq!(machine.unambiguous_friction_fraction(), 1.0);
}

/// No machine fails with coefficients below 1.4966, and one ball never fails; just above, the most
/// extreme machine fails.
#[test]
fn safe_friction_is_safe_and_sharp() {
    let mut draws = TestRng::new(17);
    for trial in 0..400 {
        let mut machine = extreme(&mut draws, 1 + trial % 6, SAFE_FRICTION);
        machine.table_mass_kg *= 1e-6;
        for ball in machine.balls.iter_mut().filter(|_| trial % 2 == 0) {
            ball.friction_coefficient = SAFE_FRICTION;
        }
        assert_eq!(machine.existence().word(), "unique", "{machine:?}");
    }
    for trial in 0..50 {
        assert_eq!(extreme(&mut draws, 1, 1e6).existence().word(), "unique", "{trial}");
    }
    let mut machine = extreme(&mut draws, 2, 0.0);
    machine.table_mass_kg = 1e-6;
    machine.imbalance_mass_kg = 1e-6;
    machine.balls = vec![Ball { friction_coefficient: 1.498, ..machine.balls[0] }; 2];
    assert_eq!(machine.existence().word(), "not_unique");
}

/// The verdict changes at the reported fraction of the friction.
#[test]
fn unambiguous_fraction_of_friction() {
    let (mut draws, mut failing) = (TestRng::new(19), 0);
    for _ in 0..100 {
        let machine = extreme(&mut draws, 3, 5.0);
        let fraction = machine.unambiguous_friction_fraction();
        let scaled = |factor: f64| {
            let mut scaled = machine.clone();
            for ball in &mut scaled.balls {
                ball.friction_coefficient *= fraction * factor;
            }
            scaled.existence().word()
        };
        assert_eq!(scaled(0.999), "unique");
        if machine.existence().word() == "not_unique" {
            failing += 1;
            assert!(fraction < 1.0);
            assert_eq!(scaled(1.001), "not_unique");
        }
    }
    assert!(failing > 20, "{failing}");
}
