//! Materials of balls: densities, and coefficients of restitution where a measurement is known.

/// A material of balls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Name in a study file.
    pub name: &'static str,
    /// Density, kg/m³.
    pub density_kg_m3: f64,
    /// Coefficient of restitution of two such balls that do not roll, at speeds below 1 m/s, if it is known.
    pub restitution: Option<f64>,
}

const fn material(name: &'static str, density_kg_m3: f64, restitution: Option<f64>) -> Material {
    Material { name, density_kg_m3, restitution }
}

/// The materials. Densities are nominal values of manufacturers of balls: bearing steel 100Cr6 and X105CrMo17, silicon nitride,
/// zirconia stabilised with yttria, alumina of 99.5 %, tungsten carbide with 6 % cobalt, soda-lime glass, CuZn39Pb3.
/// Restitution: hardened steel, W. Goldsmith, Impact, Arnold 1960 (0.9 or more at low speeds); glass, S. F. Foerster and
/// others, Phys. Fluids 6 (1994) 1108, doi:10.1063/1.868282 (0.97).
pub const MATERIALS: [Material; 8] = [
    material("steel", STEEL_KG_M3, Some(0.9)),
    material("stainless_steel", 7650.0, Some(0.9)),
    material("silicon_nitride", 3200.0, None),
    material("zirconia", 6050.0, None),
    material("alumina", 3900.0, None),
    material("tungsten_carbide", 14_900.0, None),
    material("glass", 2500.0, Some(0.97)),
    material("brass", 8470.0, None),
];

/// Density of bearing steel, kg/m³.
pub const STEEL_KG_M3: f64 = 7810.0;

impl Material {
    /// Returns the material of this name.
    pub fn named(name: &str) -> Option<Material> {
        MATERIALS.into_iter().find(|material| material.name == name)
    }
}
