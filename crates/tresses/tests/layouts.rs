//! Every struct that crosses to the GPU has the same bytes on both sides. No GPU needed.

use wgpu::naga;

/// Byte layout of a struct: (name, offset) of each member, and the whole size.
type Layout = (Vec<(String, u32)>, u32);

/// The layout of the WGSL struct `name`, from whichever linked shader has it.
fn wgsl_layout(name: &str) -> Layout {
    for (path, source) in tresses::shaders::all() {
        let module = naga::front::wgsl::parse_str(source)
            .unwrap_or_else(|error| panic!("{path}: {}", error.emit_to_string(source)));
        for (_, ty) in module.types.iter() {
            if let (Some(found), naga::TypeInner::Struct { members, span }) = (&ty.name, &ty.inner)
                && (found == name || found.ends_with(&format!("_{name}")))
            {
                let member = |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset);
                return (members.iter().map(member).collect(), *span);
            }
        }
    }
    panic!("no linked shader has a struct {name}")
}

macro_rules! rust_layout {
    ($ty:ident { $($field:ident),* $(,)? }) => {{
        // Does not compile when a field is missing.
        #[allow(unused)]
        fn exhaustive(v: $ty) { let $ty { $($field: _),* } = v; }
        (
            vec![$((stringify!($field).to_string(), std::mem::offset_of!($ty, $field) as u32)),*],
            size_of::<$ty>() as u32,
        )
    }};
}

#[test]
fn simulate() {
    use tresses::simulate::{collider::CapsuleMotion, params::StepUniforms};
    use tresses::strands::{Guide, GuideRest, GuideShape};
    assert_eq!(wgsl_layout("Guide"), rust_layout!(Guide { length, stiffness, strands, flags }));
    assert_eq!(wgsl_layout("GuideRest"), rust_layout!(GuideRest { position, contact }));
    assert_eq!(wgsl_layout("GuideShape"), rust_layout!(GuideShape { curvature, length }));
    assert_eq!(
        wgsl_layout("Capsule"),
        rust_layout!(CapsuleMotion { a_begin, radius, b_begin, _pad0, a_end, _pad1, b_end, _pad2 })
    );
    assert_eq!(
        wgsl_layout("StepUniforms"),
        rust_layout!(StepUniforms {
            head_begin,
            head_end,
            field_begin,
            field_end,
            head_begin_at,
            h,
            head_end_at,
            substeps,
            field_begin_at,
            has_field,
            field_end_at,
            capsule_count,
            field_bias,
            capsules_from,
            field_scale,
            capsules_to,
            gravity,
            drag,
            wind,
            friction,
            bending_root,
            bending_tip,
            bending_falloff,
            bending_damping,
            goal_root,
            goal_tip,
            goal_falloff,
            stretch,
            guide_count,
            vertex_count,
            mode,
            one,
        })
    );
}

#[test]
fn tessellate() {
    use tresses::{strands::GuideSample, tessellate::TessellateParams};
    assert_eq!(wgsl_layout("GuideSample"), rust_layout!(GuideSample { position, _pad, rotation }));
    assert_eq!(
        wgsl_layout("TessellateParams"),
        rust_layout!(TessellateParams {
            previous_rotation,
            current_rotation,
            head_rotation,
            previous_translation,
            blend,
            current_translation,
            guide_count,
            vertex_count,
            sample_count,
            _pad_a,
            _pad_b,
        })
    );
}

#[test]
fn interpolate() {
    use tresses::{
        interpolate::InterpolateParams,
        strands::{PackedRest, Strand, StrandBinding, StrandVertex},
    };
    assert_eq!(
        wgsl_layout("StrandBinding"),
        rust_layout!(StrandBinding { origin, extent, guides, weight_b, scale, weight_c })
    );
    assert_eq!(wgsl_layout("PackedRest"), rust_layout!(PackedRest { xy, z_radius }));
    assert_eq!(wgsl_layout("StrandVertex"), rust_layout!(StrandVertex { position, tangent }));
    assert_eq!(wgsl_layout("Strand"), rust_layout!(Strand { radius, seed, root_color, tip_color }));
    assert_eq!(
        wgsl_layout("InterpolateParams"),
        rust_layout!(InterpolateParams {
            field_rotation,
            field_translation,
            clearance,
            field_bias,
            strand_count,
            field_scale,
            vertex_count,
            sample_count,
            _pad_a,
            _pad_b,
            _pad_c,
        })
    );
}

#[test]
fn a_swapped_member_is_seen() {
    struct GuideRest {
        contact: f32,
        position: [f32; 3],
    }
    assert_ne!(wgsl_layout("GuideRest"), rust_layout!(GuideRest { contact, position }));
}
