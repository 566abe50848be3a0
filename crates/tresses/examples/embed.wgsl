// The renderer's shader: a head, a brass ring and the ground, in a key light with a shadow map and a rim light.
struct Scene { eyes: array<mat4x4f, 2>, body: mat4x4f, lights: array<vec4f, 4>, camera: vec4f }
@group(0) @binding(0) var<uniform> scene: Scene;
@group(0) @binding(1) var<storage> head: array<f32>;
@group(0) @binding(2) var<storage> corners: array<u32>;
@group(0) @binding(3) var shadow_map: texture_depth_2d;

struct Point {
    @builtin(position) clip: vec4f,
    @location(0) at: vec3f,
    @location(1) normal: vec3f,
    @location(2) color: vec3f,
    // 1 for brass, 0 for skin and ground.
    @location(3) metal: f32,
    // Intensity of the rim light.
    @location(4) rim: f32,
}

const CORNERS = array(vec2i(0, 0), vec2i(1, 0), vec2i(0, 1), vec2i(0, 1), vec2i(1, 0), vec2i(1, 1));

@vertex fn vertex(@builtin(vertex_index) i: u32, @builtin(instance_index) eye: u32) -> Point {
    var point: Point;
    point.rim = 1.0;
    let grid = i32(i) - i32(arrayLength(&corners));
    if grid < 0 {
        // The head: a vertex has seven words, which begin with position and normal.
        let word = 7 * corners[i];
        point.at = (scene.body * vec4f(head[word], head[word + 1], head[word + 2], 1.0)).xyz;
        point.normal = (scene.body * vec4f(head[word + 3], head[word + 4], head[word + 5], 0.0)).xyz;
        point.color = vec3f(0.38, 0.23, 0.17);
    } else {
        // Ring and ground are grids of 128 × 32 quads.
        let quad = vec2i(grid / 6 % 128, grid / 768 % 32);
        let uv = vec2f(quad + CORNERS[grid % 6]) / vec2f(128.0, 32.0);
        if grid < 6 * 128 * 32 {
            let angle = 6.2832 * uv;
            let out = cos(angle.x) * vec3f(0.235, -0.186, 0.954) + sin(angle.x) * vec3f(0.622, 0.783, 0.0);
            point.normal = cos(angle.y) * out + sin(angle.y) * vec3f(-0.747, 0.593, 0.3);
            point.at = vec3f(0.0, 0.09, -0.05) + 0.19 * out + 0.008 * point.normal;
            point.color = vec3f(0.85, 0.45, 0.14);
            point.metal = 1.0;
        } else {
            let rise = max(5.0 * uv.y - 2.5, 0.0);
            point.at = vec3f(6.0 * uv.x - 3.0, 0.5 * rise * rise - 0.2, 2.0 - 5.0 * uv.y);
            point.normal = normalize(vec3f(0.0, 1.0, rise));
            point.color = vec3f(0.075, 0.125, 0.155) / (1.0 + 0.25 * dot(point.at, point.at));
            point.rim = 0.0;
        }
    }
    point.clip = scene.eyes[eye] * vec4f(point.at, 1.0);
    return point;
}

fn unshadowed(at: vec3f) -> f32 {
    let clip = scene.eyes[1] * vec4f(at, 1.0);
    let texel = vec2i((vec2f(0.5, -0.5) * clip.xy / clip.w + 0.5) * vec2f(textureDimensions(shadow_map)));
    var fraction = 0.0;
    for (var i = 0; i < 81; i++) {
        fraction += f32(clip.z / clip.w >= textureLoad(shadow_map, texel + vec2i(i % 9, i / 9) - 4, 0)) / 81.0;
    }
    return fraction;
}

@fragment fn fragment(in: Point) -> @location(0) vec4f {
    let normal = normalize(in.normal);
    let eye = normalize(scene.camera.xyz - in.at);
    let up = mix(normal, reflect(-eye, normal), in.metal).y;
    var color = in.color * mix(vec3f(0.07, 0.06, 0.055), vec3f(0.24, 0.26, 0.3), 0.5 + 0.5 * up);
    let visibility = array(unshadowed(in.at + 0.01 * normal), in.rim);
    for (var light = 0u; light < 2; light++) {
        let to_light = scene.lights[2 * light].xyz;
        let gloss = pow(max(dot(normal, normalize(to_light + eye)), 0.0), mix(24.0, 90.0, in.metal));
        let thrown = mix(in.color / 3.1416 + 0.02 * gloss, in.color * (0.06 + 6.0 * gloss), in.metal);
        let arrives = max(dot(normal, to_light), 0.0) * visibility[light] * scene.lights[2 * light + 1].rgb;
        color += thrown * arrives * tresses_left_by_hair(light, in.at, normal);
    }
    return vec4f(color, 1.0);
}
