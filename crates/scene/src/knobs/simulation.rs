//! Parameters of the physics.

use super::{Change, Knob, Section, Value, knob, value::*};
use tresses::{glam::Vec3, volume::HairHairMode};

pub(super) const SECTION: Section = Section {
    key: "simulation",
    title: "Simulation",
    about: "How guides move: stiffness, damping, what hairs do to each other, the fixed step.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = &[
    Knob {
        path: "simulation.gravity",
        label: "Gravity",
        hint: "Free fall; less for hair under water, more for heavy hair.",
        kind: number(ACCELERATION, 0.0, 50.0),
        cost: Change::Frame,
        automatic: false,
        get: |settings| Value::Number(-settings.simulation.gravity.y),
        set: |settings, value| {
            if let Value::Number(v) = value {
                settings.simulation.gravity = Vec3::new(0.0, -v, 0.0);
            }
        },
    },
    knob!(
        "simulation.line_density",
        "Mass per length",
        number(LINE_DENSITY, 0.5, 100.0),
        Frame,
        "Heavier hair hangs straighter, swings longer and gives less way to the wind.",
        simulation.line_density
    )
    .log(),
    knob!(
        "simulation.bending_root",
        "Bending at the root",
        number(STIFFNESS, 0.0, 1000.0),
        Frame,
        "Stiffness against bending near the scalp; a hair of 80 µm has 8, locks have more.",
        simulation.bending.root
    )
    .log(),
    knob!(
        "simulation.bending_tip",
        "Bending at the tip",
        number(STIFFNESS, 0.0, 1000.0),
        Frame,
        "The same farther out; raise it where ends hang like strings, lower it for silk.",
        simulation.bending.tip
    )
    .log(),
    knob!(
        "simulation.bending_falloff",
        "Bending falloff",
        number(CENTIMETRES, 0.0, 100.0),
        Frame,
        "Length of hair over which the one becomes the other.",
        simulation.bending.falloff
    ),
    knob!(
        "simulation.goal_root",
        "Hold at the root",
        number(PER_SECOND_SQUARED, 0.0, 10_000.0),
        Frame,
        "Pull towards the shape at rest near the scalp; raise it where the style collapses in motion.",
        simulation.goal.root
    )
    .log(),
    knob!(
        "simulation.goal_tip",
        "Hold at the tip",
        number(PER_SECOND_SQUARED, 0.0, 10_000.0),
        Frame,
        "The same farther out, as hair spray does; 0 lets ends swing freely.",
        simulation.goal.tip
    )
    .log(),
    knob!(
        "simulation.goal_falloff",
        "Hold falloff",
        number(CENTIMETRES, 0.0, 100.0),
        Frame,
        "Length of hair over which the hold at the root becomes that at the tip.",
        simulation.goal.falloff
    ),
    knob!(
        "simulation.bending_damping",
        "Bending damping",
        number(MILLISECONDS, 0.0, 100.0),
        Frame,
        "Time in which a bend alone would relax; raise it where hair quivers.",
        simulation.bending_damping
    )
    .log(),
    knob!(
        "simulation.drag",
        "Drag",
        number(PER_SECOND, 0.0, 100.0),
        Frame,
        "How fast hair takes on the velocity of the air; raise it where swings go on for too long.",
        simulation.drag
    )
    .log(),
    knob!(
        "simulation.diameter",
        "Hair diameter",
        number(MICROMETRES, 10.0, 1000.0),
        Frame,
        "What the wind pushes against; not what is drawn.",
        simulation.diameter
    )
    .log(),
    knob!(
        "simulation.friction",
        "Friction",
        number(PLAIN, 0.0, 10.0),
        Frame,
        "Between hair and head, clothes and other obstacles; higher where hair slides off a shoulder.",
        simulation.friction
    )
    .log(),
    knob!(
        "simulation.stretch",
        "Stretch",
        number(PERCENT, 0.001, 10.0),
        Frame,
        "How much a hanging strand is stretched by its weight; higher is springier, and wrong for hair.",
        simulation.stretch
    )
    .log(),
    knob!(
        "simulation.hair_hair",
        "Hair against hair",
        choice::<HairHairMode>(),
        Frame,
        "What hair does where it is denser than at rest: nothing, a fixed push, or pressure and friction.",
        simulation.hair_hair.mode
    ),
    knob!(
        "simulation.hair_hair_speed",
        "Pressure",
        number(METRES_PER_SECOND, 0.0, 10.0),
        Frame,
        "Speed of sound of pressed hair; raise it where locks fall into each other (gradient only).",
        simulation.hair_hair.speed
    ),
    knob!(
        "simulation.hair_hair_tolerance",
        "Tolerated density",
        number(PERCENT, 0.0, 1000.0),
        Frame,
        "How much denser than at rest hair may be before it pushes.",
        simulation.hair_hair.tolerance
    )
    .log(),
    knob!(
        "simulation.hair_hair_blur",
        "Density blur",
        number(MILLIMETRES, 0.0, 100.0),
        Frame,
        "How far hair feels other hair; wider is smoother and weaker.",
        simulation.hair_hair.blur
    ),
    knob!(
        "simulation.hair_hair_friction",
        "Friction of hair on hair",
        number(PER_SECOND, 0.0, 200.0),
        Frame,
        "How fast hair takes on the motion of the hair around it; raise it for hair that moves as one.",
        simulation.hair_hair.friction
    )
    .log(),
    knob!(
        "simulation.hair_hair_limit",
        "Largest push",
        number(ACCELERATION, 0.0, 1000.0),
        Frame,
        "The strongest acceleration by other hair (gradient only).",
        simulation.hair_hair.limit
    )
    .log(),
    knob!(
        "simulation.hair_hair_fixed",
        "Fixed push",
        number(ACCELERATION, 0.0, 1000.0),
        Frame,
        "The acceleration out of cells that are too dense (fixed only).",
        simulation.hair_hair.fixed
    )
    .log(),
    knob!(
        "simulation.step",
        "Fixed step",
        number(MILLISECONDS, 1.0, 50.0),
        Frame,
        "Time that one step of the physics takes; shorter is more exact and costs more.",
        simulation.step
    )
    .log(),
    knob!(
        "simulation.substeps",
        "Solves per step",
        integer(PLAIN, 1, 32, 1),
        Frame,
        "More for stiff hair and fast motion; costs in proportion.",
        simulation.substeps
    ),
];
