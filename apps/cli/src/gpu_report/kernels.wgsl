// Kernels of the microbenchmarks. They store the results of loads, so that no compiler removes them.

@group(0) @binding(0) var<storage, read_write> words: array<atomic<u32>>;
@group(0) @binding(1) var<storage, read> source: array<u32>;
@group(0) @binding(2) var texels: texture_2d<u32>;
// Iterations of loops, and a mask for indices of `words`. No uniform: drivers would specialize kernels for its values.
@group(0) @binding(3) var<storage, read> parameters: vec4u;

@compute @workgroup_size(64)
fn empty() {}

// Each dispatch reads what the one before has written.
@compute @workgroup_size(64)
fn dependent(@builtin(global_invocation_id) id: vec3u) {
    atomicStore(&words[id.x], atomicLoad(&words[id.x]) + 1u);
}

@compute @workgroup_size(64)
fn count(@builtin(global_invocation_id) id: vec3u) {
    for (var i = 0u; i < parameters.x; i += 1u) {
        atomicAdd(&words[(id.x * 17u + i * 1021u) & parameters.y], 1u);
    }
}

// The next index depends on the loaded value, which is zero.
@compute @workgroup_size(64)
fn walk_buffer(@builtin(global_invocation_id) id: vec3u) {
    var at = id.x * 61u;
    var sum = 0u;
    for (var i = 0u; i < parameters.x; i += 1u) {
        let value = source[at & 262143u];
        sum += value;
        at += 513u + value;
    }
    atomicStore(&words[id.x & 65535u], sum);
}

@compute @workgroup_size(64)
fn walk_texture(@builtin(global_invocation_id) id: vec3u) {
    var at = id.x * 61u;
    var sum = 0u;
    for (var i = 0u; i < parameters.x; i += 1u) {
        let value = textureLoad(texels, vec2u(at & 511u, (at >> 9u) & 511u), 0).x;
        sum += value;
        at += 513u + value;
    }
    atomicStore(&words[id.x & 65535u], sum);
}
