//! The kernels for GPUs on whatever device there is: the closed forms hold in both tiers of the step.

use super::{friction, lab::for_gpus, robust, shapes, swings, twist};

#[test]
fn shapes_and_periods_hold_with_kernels_for_gpus() {
    for_gpus(&[
        shapes::catenaries_match_the_closed_form,
        shapes::heavy_cantilevers_match_the_exact_solution,
        shapes::upright_hair_buckles_at_the_critical_load,
        swings::pendulum_periods_match_the_closed_form,
        swings::hanging_chain_periods_match_the_closed_form,
        swings::cantilever_periods_match_the_closed_form,
    ]);
}

#[test]
fn twist_friction_and_lengths_hold_with_kernels_for_gpus() {
    for_gpus(&[
        twist::helical_springs_match_castiglianos_theorem,
        twist::bows_sink_by_the_closed_form,
        friction::hair_sticks_until_the_incline_is_too_steep,
        robust::shaking_and_shocks_do_not_stretch_hair,
    ]);
}
