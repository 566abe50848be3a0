//! Parameters of the physics.

use super::{Access, Knob, Section, Value, flags::flag, rows, value::*};
use tresses::{
    clock::MAX_SUBSTEPS,
    glam::Vec3,
    simulate::{Along, SimulationParams as Params},
    volume::{HairHair, HairHairMode},
};

pub(super) const SECTION: Section = Section {
    key: "simulation",
    title: "Simulation",
    about: "How guides move: stiffness, damping, forces between hairs, the fixed step.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "simulation";
    "gravity" "Gravity" {GRAVITY} number(ACCELERATION, 0.0, 50.0),
        "Free fall; less for hair under water, more for heavy hair.";
    "goal_root" "Hold at the root" [simulation.goal.root] within(PER_SECOND_SQUARED, Params::GOAL).log(),
        "Pull towards the rest shape near the scalp; raise it where the style collapses in motion.";
    "goal_tip" "Hold at the tip" [simulation.goal.tip] within(PER_SECOND_SQUARED, Params::GOAL).log(),
        "The same farther out, as hair spray does; 0 lets ends swing freely.";
    "drag" "Drag" [simulation.drag] within(PER_SECOND, Params::DRAG).log(),
        "Rate at which hair takes on the velocity of the air; raise it where swings last too long.";
    "friction" "Friction" [simulation.friction] within(PLAIN, Params::FRICTION).log(),
        "Between hair and head, clothes and other obstacles; higher where hair slides off a shoulder.";
    "hair_hair" "Hair against hair" [simulation.hair_hair.mode] choice::<HairHairMode>(),
        flag(flag("hair-hair", "MODE")),
        "What hair does where it is denser than at rest: nothing, a fixed push, or pressure and friction.";
    "hair_hair_speed" "Pressure" [simulation.hair_hair.speed] within(METRES_PER_SECOND, HairHair::SPEED),
        "Speed of sound of compressed hair; raise it where locks fall into each other (gradient only).";
    "hair_hair_friction" "Friction of hair on hair" [simulation.hair_hair.friction]
        within(PER_SECOND, HairHair::FRICTION).log(),
        "Rate at which hair takes on the motion of the hair around it; raise it for hair that moves as one.";
    "support" "Support" [simulation.support] within(PLAIN, Params::SUPPORT).log(), regrow,
        "How much stiffer than it must be hair is that stands out; raise it where an afro sways too much.";
    "twist" "Twist" [simulation.twist] within(PLAIN, Params::TWIST).log(), regrow,
        "Stiffness against twist over that against bending, 0.5 for round hair: curls spring; 0 turns it off.";
    "cohesion" "Hair holds hair" [simulation.hair_hair.cohesion]
        within(PER_SECOND_SQUARED, HairHair::COHESION).log(), regrow,
        "Springs between neighbouring guides, for hair that stands out: afros, buns, ponytails; 0 for none.";
    "cohesion_limit" "Holds up to" [simulation.hair_hair.cohesion_limit]
        within(ACCELERATION, HairHair::COHESION_LIMIT).log(), advanced,
        "The largest acceleration by one such spring; beyond, hair slides along hair.";
    "cohesion_reach" "Holds within" [simulation.hair_hair.cohesion_reach]
        within(CENTIMETRES, HairHair::COHESION_REACH).log(), advanced, regrow,
        "How far apart the guides are that hold each other.";
    "line_density" "Mass per length" [simulation.line_density] within(LINE_DENSITY, Params::LINE_DENSITY).log(), advanced,
        "Heavier hair hangs straighter, swings longer and resists the wind.";
    "bending_root" "Bending at the root" [simulation.bending.root] within(STIFFNESS, Params::BENDING).log(), advanced,
        "Bending stiffness near the scalp; a hair of 80 µm has 8, locks have more.";
    "bending_tip" "Bending at the tip" [simulation.bending.tip] within(STIFFNESS, Params::BENDING).log(), advanced,
        "The same farther out; raise it where ends hang like strings, lower it for silk.";
    "bending_falloff" "Bending falloff" [simulation.bending.falloff] within(CENTIMETRES, Along::FALLOFF), advanced,
        "Length of hair over which the stiffness at the root becomes that at the tip.";
    "goal_falloff" "Hold falloff" [simulation.goal.falloff] within(CENTIMETRES, Along::FALLOFF), advanced,
        "Length of hair over which the hold at the root becomes that at the tip.";
    "bending_damping" "Bending damping" [simulation.bending_damping] within(MILLISECONDS, Params::BENDING_DAMPING).log(),
        advanced,
        "Relaxation time of a bend by itself; raise it where hair quivers.";
    "diameter" "Hair diameter" [simulation.diameter] within(MICROMETRES, Params::DIAMETER).log(), advanced,
        "What the wind acts on; not what is drawn.";
    "stretch" "Stretch" [simulation.stretch] within(PERCENT, Params::STRETCH).log(), advanced,
        "How much a hanging strand is stretched by its weight; higher is springier, and wrong for hair.";
    "hair_hair_tolerance" "Tolerated density" [simulation.hair_hair.tolerance]
        within(PERCENT, HairHair::TOLERANCE).log(), advanced,
        "How much denser than at rest hair may be before it pushes.";
    "hair_hair_blur" "Density blur" [simulation.hair_hair.blur] within(MILLIMETRES, HairHair::BLUR), advanced,
        "Distance at which hair senses other hair; wider is smoother and weaker.";
    "hair_hair_limit" "Largest push" [simulation.hair_hair.limit] within(ACCELERATION, HairHair::LIMIT).log(),
        advanced,
        "The largest acceleration by other hair (gradient only).";
    "hair_hair_fixed" "Fixed push" [simulation.hair_hair.fixed] within(ACCELERATION, HairHair::FIXED).log(), advanced,
        "The acceleration out of cells that are too dense (fixed only).";
    "step" "Fixed step" [simulation.step] within(MILLISECONDS, Params::STEP).log(), advanced,
        "Time of one step of the physics; shorter is more exact and costs more.";
    "substeps" "Solves per step" [simulation.substeps] integer(PLAIN, 1, MAX_SUBSTEPS, 1), advanced,
        "More for stiff hair and fast motion; the cost is proportional.";
};

/// Down, as a number.
const GRAVITY: Access = Access {
    get: |settings| Value::Number(-settings.simulation.gravity.y),
    set: |settings, value| {
        if let Value::Number(v) = value {
            settings.simulation.gravity = Vec3::new(0.0, -v, 0.0);
        }
    },
    copy: |to, from| to.simulation.gravity = from.simulation.gravity,
};
