use stickslip::analysis::frictionless_equilibria;
use stickslip::model::Machine;

#[test]
fn look() {
    for drag in [1e-4, 1e-2, 1.0, 100.0, 1e4] {
        for speed in
            [-150.0, -170.0, -179.2, -180.0, -181.5, -181.7, -182.5, -184.1, -190.0, -216.0, -300.0]
        {
            let machine = Machine { speed_rad_s: speed, ..Machine::default() };
            print!("{drag:8} {speed:8}");
            for e in frictionless_equilibria(&machine, drag).unwrap() {
                print!(
                    "  {} {} {:.3e}",
                    e.kind.name(),
                    e.stability.name(),
                    e.eigenvalues_1_s[0].re
                );
            }
            println!();
        }
    }
}
#[test]
fn crossing() {
    for drag in [10.0, 100.0, 1e3, 1e4, 1e5, 1e6] {
        let (mut low, mut high) = (175.0, 220.0);
        for _ in 0..50 {
            let mid: f64 = 0.5 * (low + high);
            let machine = Machine { speed_rad_s: -mid, ..Machine::default() };
            let all = frictionless_equilibria(&machine, drag).unwrap();
            let b1 = all.last().unwrap();
            if b1.stability == stickslip::analysis::Stability::Stable {
                high = mid
            } else {
                low = mid
            }
        }
        println!("{drag} {low}");
    }
}
