//! Every struct that crosses to the GPU has the same bytes on both sides. No GPU needed.

use wgpu::naga;

use tresses::{
    body::BodyUniform,
    camera::CameraUniform,
    draw::soft::SoftUniform,
    light::{
        lights::{LightUniform, LightsUniform},
        material::HairUniform,
    },
    present::{Background, Footprint, PresentUniform},
};

/// Byte layout of a struct: (name, offset) of each member, and the whole size.
type Layout = (Vec<(String, u32)>, u32);

/// The layout of the struct `path` (module and name, as a shader imports it), which every linked shader that
/// has it agrees on.
fn wgsl_layout(path: &str) -> Layout {
    let (module, name) = path.rsplit_once("::").expect("a module and a name");
    // As the linker writes what is imported; what a shader declares itself keeps its name.
    let escaped = |part: &str| match part.matches('_').count() {
        0 => part.to_owned(),
        count => format!("_{count}{part}"),
    };
    let parts: Vec<_> = path.split("::").map(escaped).collect();
    let imported = format!("package_{}", parts.join("_"));
    let mut layout: Option<Layout> = None;
    for (shader, parsed) in parsed() {
        // One that is linked for several values of a constant has the value behind its path.
        let declares = shader.trim_end_matches(char::is_numeric).trim_end_matches("::") == module;
        let wanted = if declares { name } else { &*imported };
        for (_, ty) in parsed.types.iter().filter(|(_, ty)| ty.name.as_deref() == Some(wanted)) {
            let naga::TypeInner::Struct { members, span } = &ty.inner else { continue };
            let member = |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset);
            let found = (members.iter().map(member).collect(), *span);
            assert_eq!(layout.get_or_insert_with(|| found.clone()), &found, "{path} in {shader}");
        }
    }
    layout.unwrap_or_else(|| panic!("no linked shader has a struct {path}"))
}

/// Every linked shader, parsed once.
fn parsed() -> &'static [(&'static str, naga::Module)] {
    static PARSED: std::sync::OnceLock<Vec<(&str, naga::Module)>> = std::sync::OnceLock::new();
    let parse = |(path, source): &(&'static str, &'static str)| {
        let module = naga::front::wgsl::parse_str(source)
            .unwrap_or_else(|error| panic!("{path}: {}", error.emit_to_string(source)));
        (*path, module)
    };
    PARSED.get_or_init(|| tresses::shaders::all().iter().map(parse).collect())
}

#[test]
fn a_struct_is_found_by_its_whole_path() {
    for wrong in ["draw::View", "view::ViewUniform", "draw::body::ViewUniform"] {
        assert!(std::panic::catch_unwind(|| wgsl_layout(wrong)).is_err(), "{wrong}");
    }
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
    use tresses::strands::{Guide, PackedGuide};
    assert_eq!(
        wgsl_layout("strands::guide::Guide"),
        rust_layout!(Guide { length, stiffness, strands, flags, origin, extent })
    );
    assert_eq!(
        wgsl_layout("strands::guide::PackedGuide"),
        rust_layout!(PackedGuide { xy, z_contact, give_xy, give_z_shorter })
    );
    assert_eq!(
        wgsl_layout("simulate::params::StepUniforms"),
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
            to,
            simulated,
            spin,
            slip,
            twist,
            _pad,
        })
    );
}

#[test]
fn grab() {
    use tresses::simulate::grab::{GrabState, GrabUniform};
    assert_eq!(
        wgsl_layout("simulate::grab::params::GrabUniform"),
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
            seen_origin,
            _pad_a,
            seen_direction,
            _pad_b,
            drawn_origin,
            _pad_c,
            drawn_direction,
            _pad_d,
            shift,
            _pad_e,
        })
    );
    use tresses::simulate::shift::ShiftUniform;
    let shift = rust_layout!(ShiftUniform { way, count, velocity, faster });
    assert_eq!(wgsl_layout("simulate::shift::ShiftUniform"), shift);
    let state = rust_layout!(GrabState { hit, held, at, _pad_a, velocity, _pad_b });
    assert_eq!(wgsl_layout("simulate::grab::params::GrabState"), state);
}

#[test]
fn volume() {
    use tresses::{
        simulate::links::{Link, LinkUniforms},
        simulate::ties::{Member, Ring},
        strands::GuideForce,
        volume::params::{Blur, VolumeUniforms},
    };
    assert_eq!(
        wgsl_layout("strands::force::GuideForce"),
        rust_layout!(GuideForce { xy, z_rate, tangent, along })
    );
    assert_eq!(
        wgsl_layout("simulate::links::LinkUniforms"),
        rust_layout!(LinkUniforms { vertices, stiffness, limit, reach, span, _pad_a, _pad_b, _pad_c })
    );
    assert_eq!(wgsl_layout("simulate::links::Link"), rust_layout!(Link { other, length }));
    assert_eq!(wgsl_layout("simulate::ties::Ring"), rust_layout!(Ring { first, count }));
    assert_eq!(
        wgsl_layout("simulate::ties::Member"),
        rust_layout!(Member { rests, mass, vertex, _pad_a, _pad_b, _pad_c })
    );
    assert_eq!(
        wgsl_layout("volume::params::VolumeUniforms"),
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
            turn,
        })
    );
    let blur = rust_layout!(Blur { radius, taps, _pad_a, _pad_b, weights });
    assert_eq!(wgsl_layout("volume::params::Blur"), blur);
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
        deforms,
        low,
        _pad_b,
        high,
        _pad_c,
    });
    assert_eq!(wgsl_layout("collide::shape::ShapeData"), rust);
    assert_eq!(
        wgsl_layout("collide::build::tree::BuildParams"),
        rust_layout!(BuildParams { origin, cell, size, begin, tile, end, sign, node_count, jump, _pad })
    );
    let rust = rust_layout!(TreeNode { low, first, high, count, center, radius, area, skip });
    assert_eq!(wgsl_layout("collide::build::tree::TreeNode"), rust);
    assert_eq!(wgsl_layout("collide::shape::ShapeTable"), rust_layout!(ShapeTable { list }));
    assert_eq!(
        wgsl_layout("collide::shape::Place"),
        rust_layout!(Place { rotation, translation, bound, center, _pad })
    );
    // The shader's struct ends with the places themselves.
    let (members, size) = rust_layout!(Places { interval, moments, count, side });
    let found = wgsl_layout("collide::shape::Places").0;
    assert_eq!(found[..members.len()], members);
    assert_eq!(found[members.len()..], [("list".to_string(), size)]);

    use tresses::collide::deform::{DeformHead, DeformNode, DeformPart};
    assert_eq!(
        wgsl_layout("collide::deform::gather::DeformNode"),
        rust_layout!(DeformNode { triangle, b, rest, c })
    );
    assert_eq!(
        wgsl_layout("collide::deform::deforms::DeformPart"),
        rust_layout!(DeformPart { rotation, translation, _pad_a, low, _pad_b, per_metre, _pad_c })
    );
    let (members, size) = rust_layout!(DeformHead {
        count,
        position_first,
        position_stride,
        side,
        fresh,
        most,
        _pad_a,
        _pad_b,
    });
    let found = wgsl_layout("collide::deform::deforms::Deforms").0;
    assert_eq!(found[..members.len()], members);
    assert_eq!(found[members.len()..], [("parts".to_string(), size)]);
}

#[test]
fn tessellate() {
    use tresses::{strands::GuideSample, tessellate::TessellateParams};
    assert_eq!(wgsl_layout("strands::guide::GuideSample"), rust_layout!(GuideSample { place, turn }));
    assert_eq!(
        wgsl_layout("tessellate::walk::TessellateParams"),
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
            span,
            twists,
            head_translation,
            _pad_b,
        })
    );
}

#[test]
fn roots() {
    use tresses::{
        roots::{GuideRoot, RootsUniform, StrandRoot},
        strands::RootMotion,
    };
    assert_eq!(
        wgsl_layout("strands::root::RootMotion"),
        rust_layout!(RootMotion {
            begin_rotation,
            end_rotation,
            before_rotation,
            now_rotation,
            begin_at,
            _pad_a,
            end_at,
            _pad_b,
            before_at,
            _pad_c,
            now_at,
            _pad_d,
        })
    );
    assert_eq!(
        wgsl_layout("roots::surface::RootsUniform"),
        rust_layout!(RootsUniform {
            to_world_rotation,
            to_head_rotation,
            to_world,
            position_first,
            to_head,
            position_stride,
            normal_first,
            normal_stride,
            guide_count,
            strand_count,
            fresh,
            _pad_a,
            _pad_b,
            _pad_c,
        })
    );
    let guide = rust_layout!(GuideRoot { triangle, b, rest_at, c, rest_back });
    assert_eq!(wgsl_layout("roots::guides::GuideRoot"), guide);
    let strand = rust_layout!(StrandRoot { triangle, b, offset, c });
    assert_eq!(wgsl_layout("roots::strands::StrandRoot"), strand);
}

#[test]
fn interpolate() {
    use tresses::{
        interpolate::InterpolateParams,
        strands::{PackedRest, Strand, StrandBinding, StrandVertex},
    };
    assert_eq!(
        wgsl_layout("strands::binding::StrandBinding"),
        rust_layout!(StrandBinding { origin, extent, guides, weight_b, scale, weight_c })
    );
    assert_eq!(wgsl_layout("strands::binding::PackedRest"), rust_layout!(PackedRest { xy, z_radius_sunk }));
    assert_eq!(
        wgsl_layout("strands::vertex::StrandVertex"),
        rust_layout!(StrandVertex { position, tangent })
    );
    assert_eq!(
        wgsl_layout("strands::strand::Strand"),
        rust_layout!(Strand { radius, seed, root_color, tip_color })
    );
    assert_eq!(
        wgsl_layout("interpolate::strand::InterpolateParams"),
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
    assert_eq!(
        wgsl_layout("avoid::state::StrandState"),
        rust_layout!(StrandState { hit, amount, at, hit_before })
    );
    assert_eq!(
        wgsl_layout("avoid::obstacles::AvoidParams"),
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
    assert_eq!(
        wgsl_layout("lod::widths::StrandLod"),
        rust_layout!(StrandLod { radius, span, density, thickness })
    );
    assert_eq!(
        wgsl_layout("lod::widths::WidthParams"),
        rust_layout!(WidthParams { weights, fraction, width, count, _pad })
    );
}

#[test]
fn a_swapped_member_is_seen() {
    struct StrandVertex {
        tangent: u32,
        position: [f32; 3],
    }
    let wrong = rust_layout!(StrandVertex { tangent, position });
    assert_ne!(wgsl_layout("strands::vertex::StrandVertex"), wrong);
}

#[test]
fn view() {
    let rust = rust_layout!(CameraUniform { view_projection, eye, pixel, size, samples, ssaa, way });
    assert_eq!(wgsl_layout("camera::CameraUniform"), rust);
}

#[test]
fn lights() {
    let light = rust_layout!(LightUniform { direction, _pad_a, irradiance, _pad_b });
    assert_eq!(wgsl_layout("light::lights::LightUniform"), light);
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
        strand_by_strand,
        environment,
        ambient_origin,
        ambient_scale,
        passes,
        forward,
        zone,
        every,
        strand_map,
        _pad_d,
    });
    assert_eq!(wgsl_layout("light::lights::LightsUniform"), rust);
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
        knot_stride,
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
        first,
        spans,
        single,
        dense,
        sunk,
        packed,
        _pad,
    });
    assert_eq!(wgsl_layout("light::material::HairUniform"), rust);
}

#[test]
fn body() {
    let rust = rust_layout!(BodyUniform { pose, color, gloss, wrap, gloss_exponent, outward, _pad });
    assert_eq!(wgsl_layout("draw::body::BodyUniform"), rust);
}

#[test]
fn soft() {
    let rust = rust_layout!(SoftUniform { across, wide, high, zone, first, size });
    assert_eq!(wgsl_layout("draw::soft::point::SoftUniform"), rust);
}

#[test]
fn background() {
    let rust = rust_layout!(Background { center, transparent, edge, falloff });
    assert_eq!(wgsl_layout("draw::background::Background"), rust);
}

#[test]
fn present() {
    let rust = rust_layout!(PresentUniform {
        background,
        size,
        exposure,
        shoulder,
        desaturation,
        _pad_a,
        _pad_b,
        _pad_c,
    });
    assert_eq!(wgsl_layout("present::tonemap::PresentUniform"), rust);
    assert_eq!(
        wgsl_layout("present::resolve::Footprint"),
        rust_layout!(Footprint { samples, count, _pad_a, _pad_b, _pad_c })
    );
}

#[test]
fn embed() {
    use tresses::{
        draw::embed::{EmbedUniform, shade::ShadeUniform},
        light::scene::SceneUniform,
    };
    assert_eq!(
        wgsl_layout("draw::embed::scene::EmbedUniform"),
        rust_layout!(EmbedUniform { depth, samples, ssaa, origin, size, _pad })
    );
    assert_eq!(
        wgsl_layout("draw::embed::shade::shaded::ShadeUniform"),
        rust_layout!(ShadeUniform { to_eye, to_world, origin, size, strength, reach, nothing, lights })
    );
    assert_eq!(
        wgsl_layout("light::scene::bring::SceneUniform"),
        rust_layout!(SceneUniform { to_scene, origin, size, bias, apart, nothing, edge })
    );
}

#[test]
fn debug_views() {
    use tresses::views::{
        ArrowsUniform, GridUniform, GuidesUniform, LinePoint, LinesUniform, PaintUniform, SliceUniform,
        StrandsUniform, StreamsUniform,
    };
    let paint = rust_layout!(PaintUniform { inverse, low, high, opacity, encode });
    assert_eq!(wgsl_layout("views::paint::PaintUniform"), paint);
    let grid = rust_layout!(GridUniform { rotation, translation, quantity, scale, turns, bias, _pad });
    assert_eq!(wgsl_layout("views::grid::GridUniform"), grid);
    assert_eq!(
        wgsl_layout("views::slices::SliceUniform"),
        rust_layout!(SliceUniform { at, panels, panel, contours, _pad_a, _pad_b, _pad_c })
    );
    assert_eq!(
        wgsl_layout("views::line::LinePoint"),
        rust_layout!(LinePoint { position, value, width, alpha, tint, _pad })
    );
    assert_eq!(wgsl_layout("views::lines::LinesUniform"), rust_layout!(LinesUniform { points, rim, _pad }));
    let arrows = rust_layout!(ArrowsUniform { first, seconds, step, longest, count, least });
    assert_eq!(wgsl_layout("views::arrows::ArrowsUniform"), arrows);
    assert_eq!(
        wgsl_layout("views::streams::StreamsUniform"),
        rust_layout!(StreamsUniform { seeds, points, step, least })
    );
    let guides = rust_layout!(GuidesUniform {
        count,
        vertex_count,
        sample_count,
        quantity,
        rotation,
        translation,
        _pad
    });
    assert_eq!(wgsl_layout("views::guides::GuidesUniform"), guides);
    let strands = rust_layout!(StrandsUniform { eye, quantity, high, _pad_a, _pad_b, _pad_c });
    assert_eq!(wgsl_layout("views::strands::StrandsUniform"), strands);
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
    assert_eq!(wgsl_layout("draw::background::Background"), rust);
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
    assert_eq!(wgsl_layout("wind::grid::GustMode"), rust_layout!(GustMode { wave, phase, amplitude, _pad }));
    assert_eq!(
        wgsl_layout("wind::grid::Half"),
        rust_layout!(Half { color, keep_own, keep_other, relaxation })
    );
    assert_eq!(
        wgsl_layout("wind::grid::WindUniforms"),
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
            kick,
            _pad_kick,
            gusts,
        })
    );
    assert_eq!(
        wgsl_layout("simulate::forces::AirUniforms"),
        rust_layout!(AirUniforms { corner, scale, drag, reynolds, weight, blows })
    );
}

#[test]
fn tiles() {
    use tresses::draw::tiles::geometry::GeometryUniform;
    use tresses::draw::tiles::state::{Control, Grid, Part};
    assert_eq!(
        wgsl_layout("draw::tiles::grid::Grid"),
        rust_layout!(Grid { size, tiles, points, id_bits, window, _pad })
    );
    assert_eq!(
        wgsl_layout("draw::tiles::geometry::GeometryUniform"),
        rust_layout!(GeometryUniform { before, depth, is_known, _pad })
    );
    assert_eq!(
        wgsl_layout("draw::tiles::project::Part"),
        rust_layout!(Part { first, count, vertex_count, room })
    );
    assert_eq!(
        wgsl_layout("draw::tiles::grid::Control"),
        rust_layout!(Control {
            segments,
            bins,
            rows,
            segments_again,
            bins_again,
            deep_tiles,
            deep_rows,
            busy,
            entries,
            _pad
        })
    );
}
