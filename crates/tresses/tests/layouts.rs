//! Every struct that crosses to the GPU has the same bytes on both sides. No GPU needed.

use wgpu::naga;

use tresses::{
    body::BodyUniform,
    camera::CameraUniform,
    light::{
        lights::{LightUniform, LightsUniform},
        material::HairUniform,
    },
    present::{Background, Footprint, PresentUniform},
};

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
    use tresses::simulate::params::StepUniforms;
    use tresses::strands::{Guide, GuideRest, GuideShape};
    assert_eq!(wgsl_layout("Guide"), rust_layout!(Guide { length, stiffness, strands, flags }));
    assert_eq!(wgsl_layout("GuideRest"), rust_layout!(GuideRest { position, contact }));
    assert_eq!(wgsl_layout("GuideShape"), rust_layout!(GuideShape { curvature, length }));
    assert_eq!(
        wgsl_layout("StepUniforms"),
        rust_layout!(StepUniforms {
            head_begin,
            head_end,
            head_begin_at,
            h,
            head_end_at,
            substeps,
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
            moment,
            forced,
            _pad_a,
            _pad_b,
        })
    );
}

#[test]
fn grab() {
    use tresses::simulate::grab::{GrabState, GrabUniform};
    assert_eq!(
        wgsl_layout("GrabUniform"),
        rust_layout!(GrabUniform {
            origin,
            radius,
            direction,
            share,
            target_at,
            step,
            toward,
            settle,
            guide_count,
            vertex_count,
            strand_count,
            strand_vertices,
            forced,
            moment,
            aside,
            strongest,
        })
    );
    let state = rust_layout!(GrabState { hit, held, at, _pad_a, velocity, _pad_b });
    assert_eq!(wgsl_layout("GrabState"), state);
}

#[test]
fn volume() {
    use tresses::{
        strands::GuideForce,
        volume::params::{Blur, VolumeUniforms},
    };
    assert_eq!(wgsl_layout("GuideForce"), rust_layout!(GuideForce { xy, z_rate, tangent, along }));
    assert_eq!(
        wgsl_layout("VolumeUniforms"),
        rust_layout!(VolumeUniforms {
            head,
            head_at,
            resolution,
            bias,
            scale,
            drift,
            cell,
            one,
            mode,
            resting,
            guide_count,
            vertex_count,
            stride,
            splat_count,
            units,
            density,
            reference,
            speed_squared,
            tolerance,
            friction,
            limit,
            fixed_push,
            moment,
            vertices_per_sample,
            samples,
            _pad_a,
            _pad_b,
        })
    );
    let blur = rust_layout!(Blur { radius, taps, _pad_a, _pad_b, weights });
    assert_eq!(wgsl_layout("Blur"), blur);
}

#[test]
fn collide() {
    use tresses::collide::build::{BuildParams, TreeNode};
    use tresses::collide::{Place, Places, ShapeData, ShapeTable};
    let rust = rust_layout!(ShapeData {
        center,
        bound,
        size,
        kind,
        bias,
        friction,
        scale,
        _pad_a,
        low,
        _pad_b,
        high,
        _pad_c,
    });
    assert_eq!(wgsl_layout("ShapeData"), rust);
    assert_eq!(
        wgsl_layout("BuildParams"),
        rust_layout!(BuildParams { origin, cell, size, begin, tile, end, sign, node_count, jump, _pad })
    );
    let rust = rust_layout!(TreeNode { low, first, high, count, center, radius, area, skip });
    assert_eq!(wgsl_layout("TreeNode"), rust);
    assert_eq!(wgsl_layout("ShapeTable"), rust_layout!(ShapeTable { count, has_head, _pad_a, _pad_b, list }));
    assert_eq!(wgsl_layout("Place"), rust_layout!(Place { rotation, translation, bound, center, _pad }));
    // The shader's struct ends with the places themselves.
    let (members, size) = rust_layout!(Places { interval, moments, _pad_a, _pad_b });
    let found = wgsl_layout("Places").0;
    assert_eq!(found[..members.len()], members);
    assert_eq!(found[members.len()..], [("list".to_string(), size)]);
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
    assert_eq!(wgsl_layout("PackedRest"), rust_layout!(PackedRest { xy, z_radius_sunk }));
    assert_eq!(wgsl_layout("StrandVertex"), rust_layout!(StrandVertex { position, tangent }));
    assert_eq!(wgsl_layout("Strand"), rust_layout!(Strand { radius, seed, root_color, tip_color }));
    assert_eq!(
        wgsl_layout("InterpolateParams"),
        rust_layout!(InterpolateParams {
            strand_count,
            vertex_count,
            sample_count,
            rest_count,
            stride,
            _pad_a,
            _pad_b,
            _pad_c,
        })
    );
}

#[test]
fn avoid() {
    use tresses::avoid::{AvoidParams, StrandState};
    assert_eq!(wgsl_layout("StrandState"), rust_layout!(StrandState { hit, amount, at, hit_before }));
    assert_eq!(
        wgsl_layout("AvoidParams"),
        rust_layout!(AvoidParams {
            clearance,
            tolerance,
            zone,
            tightness,
            strand_count,
            vertex_count,
            sample_count,
            fresh,
            keep,
            rise,
            fall,
            shift,
            rest_count,
            stride,
            _pad_a,
            _pad_b,
        })
    );
}

#[test]
fn lod() {
    use tresses::lod::{StrandLod, WidthParams};
    assert_eq!(wgsl_layout("StrandLod"), rust_layout!(StrandLod { radius, span, density, thickness }));
    assert_eq!(
        wgsl_layout("WidthParams"),
        rust_layout!(WidthParams { weights, fraction, width, count, _pad })
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

#[test]
fn view() {
    let rust = rust_layout!(CameraUniform {
        view_projection,
        eye,
        pixel,
        size,
        samples,
        ssaa,
        exposure,
        shoulder,
        desaturation,
        _pad,
        way
    });
    assert_eq!(wgsl_layout("CameraUniform"), rust);
}

#[test]
fn lights() {
    let light = rust_layout!(LightUniform { direction, _pad_a, irradiance, _pad_b });
    assert_eq!(wgsl_layout("LightUniform"), light);
    let rust = rust_layout!(LightsUniform {
        shadow,
        directional,
        zenith,
        count,
        horizon,
        resolution,
        ground,
        hair_texels,
        range,
        width,
        hair_radius,
        body_radius,
        bias,
        density,
        body_opacity,
        method,
        per_pixel,
        ambient,
        maps,
        _pad,
        environment,
        ambient_origin,
        ambient_scale,
        passes,
        forward,
    });
    assert_eq!(wgsl_layout("LightsUniform"), rust);
}

#[test]
fn hair() {
    let rust = rust_layout!(HairUniform {
        root_color,
        lightness_spread,
        tip_color,
        warmth_spread,
        secondary_color,
        root_darkness,
        diffuse,
        primary,
        primary_exponent,
        primary_shift,
        secondary,
        secondary_exponent,
        secondary_shift,
        transmission,
        transmission_exponent,
        shift_spread,
        shift_noise,
        opacity,
        saturation,
        min_width,
        file_colors,
        count,
        vertex_count,
        per_vertex,
        splat_stride,
        splat_segments,
        variances,
        turn_sin,
        turn_cos,
        root_absorption,
        model,
        tip_absorption,
        melanin_spread,
        tilt_spread,
        density_forward,
        density_back,
        color_fit,
        rest_count,
        stride,
        deeper,
        area,
        _pad_b,
        _pad_c,
        _pad_d,
    });
    assert_eq!(wgsl_layout("HairUniform"), rust);
}

#[test]
fn body() {
    let rust = rust_layout!(BodyUniform { pose, color, gloss, wrap, gloss_exponent, outward, _pad });
    assert_eq!(wgsl_layout("BodyUniform"), rust);
}

#[test]
fn background() {
    let rust = rust_layout!(Background { center, transparent, edge, falloff });
    assert_eq!(wgsl_layout("Background"), rust);
}

#[test]
fn present() {
    let rust = rust_layout!(PresentUniform {
        background,
        size,
        exposure,
        shoulder,
        desaturation,
        ssaa,
        samples,
        encode,
    });
    assert_eq!(wgsl_layout("PresentUniform"), rust);
    assert_eq!(wgsl_layout("Footprint"), rust_layout!(Footprint { samples, count, _pad_a, _pad_b, _pad_c }));
}

#[test]
fn embed() {
    use tresses::draw::embed::EmbedUniform;
    assert_eq!(wgsl_layout("EmbedUniform"), rust_layout!(EmbedUniform { depth, samples, ssaa, _pad }));
}

#[test]
fn debug_views() {
    use tresses::draw::debug::{
        ArrowsUniform, GridUniform, GuidesUniform, LinePoint, LinesUniform, PaintUniform, SliceUniform,
        StrandsUniform, StreamsUniform,
    };
    let paint = rust_layout!(PaintUniform { inverse, low, high, opacity, encode });
    assert_eq!(wgsl_layout("PaintUniform"), paint);
    let grid = rust_layout!(GridUniform { rotation, translation, quantity, scale, turns, bias, _pad });
    assert_eq!(wgsl_layout("GridUniform"), grid);
    assert_eq!(
        wgsl_layout("SliceUniform"),
        rust_layout!(SliceUniform { at, panels, panel, contours, _pad_a, _pad_b, _pad_c })
    );
    assert_eq!(
        wgsl_layout("LinePoint"),
        rust_layout!(LinePoint { position, value, width, alpha, tint, _pad })
    );
    assert_eq!(wgsl_layout("LinesUniform"), rust_layout!(LinesUniform { points, rim, _pad }));
    let arrows = rust_layout!(ArrowsUniform { first, seconds, step, longest, count, least });
    assert_eq!(wgsl_layout("ArrowsUniform"), arrows);
    assert_eq!(wgsl_layout("StreamsUniform"), rust_layout!(StreamsUniform { seeds, points, step, least }));
    let guides = rust_layout!(GuidesUniform { count, vertex_count, sample_count, quantity });
    assert_eq!(wgsl_layout("GuidesUniform"), guides);
    let strands = rust_layout!(StrandsUniform { eye, quantity, high, _pad_a, _pad_b, _pad_c });
    assert_eq!(wgsl_layout("StrandsUniform"), strands);
}

#[test]
#[should_panic(expected = "left == right")]
fn a_wrong_order_is_seen() {
    #[allow(dead_code)]
    #[repr(C)]
    struct Wrong {
        center: [f32; 3],
        transparent: u32,
        falloff: f32,
        edge: [f32; 3],
    }
    let rust = rust_layout!(Wrong { center, transparent, falloff, edge });
    assert_eq!(wgsl_layout("Background"), rust);
}

#[test]
fn wind() {
    use tresses::{
        simulate::AirUniforms,
        wind::{
            gusts::GustMode,
            params::{Half, WindUniforms},
        },
    };
    assert_eq!(wgsl_layout("GustMode"), rust_layout!(GustMode { wave, phase, amplitude, _pad }));
    assert_eq!(wgsl_layout("Half"), rust_layout!(Half { color, keep_own, keep_other, relaxation }));
    assert_eq!(
        wgsl_layout("WindUniforms"),
        rust_layout!(WindUniforms {
            mean,
            cells,
            shift,
            reach,
            head,
            head_at,
            cell,
            corner,
            moment,
            hair_bias,
            hair_scale,
            reset,
            inflow,
            gust_count,
            drag,
            reynolds,
            one,
            plain,
            _pad,
            gusts,
        })
    );
    assert_eq!(
        wgsl_layout("AirUniforms"),
        rust_layout!(AirUniforms { corner, scale, drag, reynolds, weight, blows })
    );
}
