//! Parameters of the physics.

use super::{Access, Knob, Section, Value, flags::flag, rows, value::*};
use tresses::{
    HairHair, HairHairMode, RestOptions, RootToTip, SimulationParams as Params, glam::Vec3,
    low_level::MAX_SUBSTEPS,
};

pub(super) const SECTION: Section = Section {
    key: "simulation",
    title: "Simulation",
    about: "Motion of guides: stiffness, damping, self-collision, and the fixed step.",
    knobs: KNOBS,
};

const KNOBS: &[Knob] = rows! { "simulation";
    "gravity" "Gravity" {GRAVITY} number(ACCELERATION, 0.0, 50.0),
        also("gravity vector; gravity magnitude"),
        "Acceleration of free fall; lower for hair under water, higher for heavy hair.";
    "goal_root" "Shape stiffness, root" [simulation.goal.root] within(PER_SECOND_SQUARED, Params::GOAL).log(),
        also("global stiffness; global shape stiffness; global constraint stiffness; pin goal strength; goal strength; shape matching"),
        "Pull toward the rest shape near the scalp; raise it if the style collapses in motion.";
    "goal_tip" "Shape stiffness, tip" [simulation.goal.tip] within(PER_SECOND_SQUARED, Params::GOAL).log(),
        also("goal strength"),
        "Pull toward the rest shape near the tip, like hair spray; 0 lets ends swing freely.";
    "drag" "Drag" [simulation.drag] within(PER_SECOND, Params::DRAG).log(),
        also("air drag; damping; air resistance"),
        "Rate at which hair takes on the velocity of the air; raise it if hair swings too long.";
    "friction" "Friction" [simulation.friction] within(PLAIN, Params::FRICTION).log(),
        also("kinetic friction; static friction"),
        "Friction on the head, clothes and other colliders; raise it if hair slides off a shoulder.";
    "hair_hair" "Self-collision" [simulation.hair_hair.mode] choice::<HairHairMode>(),
        flag(flag("hair-hair", "MODE")),
        also("self collision; hair collision"),
        "Response of hair that is denser than at rest: none, a fixed push, or pressure and friction.";
    "hair_hair_speed" "Pressure" [simulation.hair_hair.speed] within(METERS_PER_SECOND, HairHair::SPEED),
        also("density strength; hair repulsion"),
        "Repulsion stiffness, as the speed of sound in hair; raise it if locks interpenetrate (gradient only).";
    "hair_hair_friction" "Hair-hair friction" [simulation.hair_hair.friction]
        within(PER_SECOND, HairHair::FRICTION).log(),
        also("strands viscosity; internal friction; hair viscosity"),
        "Rate at which hair takes on the motion of nearby hair; raise it for hair that moves as one.";
    "support" "Support" [rest.support] within(PLAIN, RestOptions::SUPPORT).log(),
        "Extra stiffness of upright hair; raise it if an afro sways too much.";
    "twist" "Twist" [simulation.twist] within(PLAIN, Params::TWIST).log(),
        also("torsion; twist stiffness"),
        "Torsional stiffness over bending stiffness, 0.5 for round hair; makes curls spring. 0 turns it off.";
    "cohesion" "Cohesion" [simulation.hair_hair.cohesion]
        within(PER_SECOND_SQUARED, HairHair::COHESION).log(),
        "Stiffness of springs between neighboring guides, for afros, buns and ponytails; 0 for none.";
    "cohesion_limit" "Cohesion limit" [simulation.hair_hair.cohesion_limit]
        within(ACCELERATION, HairHair::COHESION_LIMIT).log(), advanced,
        "Maximum acceleration by one cohesion spring; beyond it, hair slides along hair.";
    "cohesion_distance" "Cohesion distance" [simulation.hair_hair.cohesion_distance]
        within(CENTIMETERS, HairHair::COHESION_DISTANCE).log(), advanced,
        "Maximum distance of guides that a cohesion spring connects.";
    "line_density" "Mass per length" [simulation.line_density] within(LINE_DENSITY, Params::LINE_DENSITY).log(), advanced,
        also("hair mass; vertex mass; strands density; linear density"),
        "Heavier hair hangs straighter, swings longer and resists the wind.";
    "bending_root" "Bending at the root" [simulation.bending.root] within(STIFFNESS, Params::BENDING).log(), advanced,
        also("bend stiffness; local stiffness; local shape stiffness; local constraint stiffness"),
        "Bending stiffness near the scalp; a hair of 80 µm has 8, locks have more.";
    "bending_tip" "Bending at the tip" [simulation.bending.tip] within(STIFFNESS, Params::BENDING).log(), advanced,
        also("bend stiffness; bend stiffness scale"),
        "Bending stiffness near the tip; raise it if ends hang like strings, lower it for silk.";
    "bending_falloff" "Bending falloff" [simulation.bending.falloff] within(CENTIMETERS, RootToTip::FALLOFF), advanced,
        also("bend stiffness scale"),
        "Length of hair over which bending stiffness changes from its root to its tip value.";
    "goal_falloff" "Shape falloff" [simulation.goal.falloff] within(CENTIMETERS, RootToTip::FALLOFF), advanced,
        also("global range; global shape range; global constraints range"),
        "Length of hair over which shape stiffness changes from its root to its tip value.";
    "bending_damping" "Bending damping" [simulation.bending_damping] within(MILLISECONDS, Params::BENDING_DAMPING).log(),
        advanced,
        also("bend damping"),
        "Relaxation time of bending; raise it if hair quivers.";
    "diameter" "Hair diameter" [simulation.diameter] within(MICROMETERS, Params::DIAMETER).log(), advanced,
        "Diameter that the wind acts on; the drawn width is a separate parameter.";
    "stretch" "Stretch" [simulation.stretch] within(PERCENT, Params::STRETCH).log(), advanced,
        also("stretch stiffness; stretchiness"),
        "Strain of a hanging strand under its weight; higher is springier, and unrealistic for hair.";
    "hair_hair_tolerance" "Tolerated density" [simulation.hair_hair.tolerance]
        within(PERCENT, HairHair::TOLERANCE).log(), advanced,
        "Density above the rest density up to which hair does not push.";
    "hair_hair_blur" "Density blur" [simulation.hair_hair.blur] within(MILLIMETERS, HairHair::BLUR), advanced,
        "Radius over which the density is blurred; wider is smoother and weaker.";
    "hair_hair_limit" "Maximum push" [simulation.hair_hair.limit] within(ACCELERATION, HairHair::LIMIT).log(),
        advanced,
        "Maximum acceleration by other hair (gradient only).";
    "hair_hair_fixed" "Fixed push" [simulation.hair_hair.fixed] within(ACCELERATION, HairHair::FIXED).log(), advanced,
        "Acceleration out of cells that are too dense (fixed only).";
    "step" "Fixed step" [simulation.step] within(MILLISECONDS, Params::STEP).log(), advanced,
        also("time step; timestep"),
        "Duration of one simulation step; shorter is more accurate and costs more.";
    "substeps" "Substeps" [simulation.substep_count] integer(PLAIN, 1, MAX_SUBSTEPS, 1), advanced,
        also("sub steps; quality steps"),
        "Substeps per step; more for stiff hair and fast motion, at proportional cost.";
};

/// Downward acceleration as a number.
const GRAVITY: Access = Access {
    get: |settings| Value::Number(-settings.simulation.gravity.y),
    set: |settings, value| {
        if let Value::Number(v) = value {
            settings.simulation.gravity = Vec3::new(0.0, -v, 0.0);
        }
    },
    copy: |to, from| to.simulation.gravity = from.simulation.gravity,
};
