//! Air drag on a hair: quadratic, different across the hair and along it.
//!
//! Per length, the drag is `½ ρ C_n d |u_n| u_n` across and `½ ρ C_t π d |u_t| u_t` along the hair, where `u` is the
//! air's velocity relative to the hair. A hair is so thin that the coefficients depend on the Reynolds number (about 27
//! in 5 m/s). Across the hair they follow Sucker and Brauer (1975), along it Matsui (1976), who measured filaments
//! being spun. The terminal speed of a horizontal hair is 0.7 m/s, so it flies in any breeze.

#[cfg(test)]
use glam::{Vec2, Vec3};

/// Density of air, kg/m³.
pub const AIR_DENSITY: f32 = 1.2;
/// Kinematic viscosity of air, m²/s.
pub const AIR_VISCOSITY: f32 = 1.5e-5;

/// Returns the drag coefficient of a long cylinder across the flow, for Reynolds numbers up to 1e3.
#[cfg(test)]
pub(crate) fn normal_coefficient(reynolds: f32) -> f32 {
    let re = reynolds.max(1e-2);
    1.18 + 6.8 * re.powf(-0.89) + 1.96 / re.sqrt()
}

/// Returns the friction coefficient of a long cylinder along the flow, relative to its whole surface.
#[cfg(test)]
pub(crate) fn tangential_coefficient(reynolds: f32) -> f32 {
    0.37 * reynolds.max(1e-2).powf(-0.61)
}

/// Returns half of air density times diameter over line density, 1/m: the `weight` of [`drag_rates`].
pub fn drag_weight(diameter: f32, line_density: f32) -> f32 {
    0.5 * AIR_DENSITY * diameter / line_density
}

/// Returns the rates (1/s) at which a hair approaches the velocity of the air across itself (x) and along itself (y).
/// `relative` is the air's velocity relative to the hair, m/s; `tangent` is a unit vector; `reynolds` is diameter over
/// kinematic viscosity, s/m; `weight` comes from [`drag_weight`].
#[cfg(test)]
pub fn drag_rates(relative: Vec3, tangent: Vec3, reynolds: f32, weight: f32) -> Vec2 {
    let axial_speed = relative.dot(tangent);
    let along = axial_speed.abs();
    // Not by Pythagoras: for a storm along the hair, its rounding would add a breeze across it.
    let across = (relative - axial_speed * tangent).length();
    weight
        * Vec2::new(
            normal_coefficient(across * reynolds) * across,
            std::f32::consts::PI * tangential_coefficient(along * reynolds) * along,
        )
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIAMETER: f32 = 80e-6;
    const LINE_DENSITY: f32 = 6.6e-6;

    fn rates(relative: Vec3, tangent: Vec3) -> Vec2 {
        drag_rates(relative, tangent, DIAMETER / AIR_VISCOSITY, drag_weight(DIAMETER, LINE_DENSITY))
    }

    #[test]
    fn coefficients_match_measured_cylinders() {
        // Measured drag of cylinders (Wieselsberger 1921): 10 at Re 1, 2.8 at 10, 1.45 at 100.
        for (re, measured) in [(1.0, 10.0), (10.0, 2.8), (100.0, 1.45)] {
            assert!(
                (normal_coefficient(re) / measured - 1.0).abs() < 0.12,
                "{re}: {}",
                normal_coefficient(re)
            );
        }
        assert!(normal_coefficient(0.0).is_finite() && tangential_coefficient(0.0).is_finite());
    }

    #[test]
    fn drag_is_far_larger_across_than_along() {
        let across = rates(Vec3::X * 5.0, Vec3::Y);
        let along = rates(Vec3::Y * 5.0, Vec3::Y);
        assert!(across.y == 0.0 && along.x == 0.0);
        let ratio = across.x / along.y;
        assert!((8.0..20.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn horizontal_hair_reaches_terminal_velocity() {
        // Weight and drag balance where speed times rate is gravity.
        let mut speed = 0.0f32;
        for _ in 0..10_000 {
            let rate = rates(Vec3::Y * speed, Vec3::X).x;
            speed = (speed + 1e-3 * 9.81) / (1.0 + 1e-3 * rate);
        }
        let re = speed * DIAMETER / AIR_VISCOSITY;
        let force = 0.5 * AIR_DENSITY * normal_coefficient(re) * DIAMETER * speed * speed;
        assert!((force / (LINE_DENSITY * 9.81) - 1.0).abs() < 1e-3, "{force}");
        assert!((0.4..0.8).contains(&speed), "{speed} m/s");
    }
}
