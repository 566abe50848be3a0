"""Hair drawn by Tresses in the viewport, with depth against Blender's objects, while a live simulation runs."""

import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from .space import ROTATION

_handle = None
_last = None
_shader = None

VERTEX = "void main() { place = pos * 0.5 + 0.5; gl_Position = vec4(pos, 0.0, 1.0); }"
FRAGMENT = """
void main() {
    vec4 texel = texture(image, place);
    if (texel.a <= 0.0) discard;
    gl_FragDepth = texture(depth, place).r;
    color = texel;
}
"""


def matrices(view, projection, unit):
    """Return Blender's view and projection for a camera of Tresses: meters, Y up, reversed depth."""
    rotation = np.eye(4)
    rotation[:3, :3] = ROTATION
    view, projection = np.array(view, np.float64) @ rotation.T, np.array(projection, np.float64)
    view[:3, 3] *= unit
    tresses_projection = projection.copy()
    tresses_projection[:, :3] /= unit
    # Blender's depth is -w at the near plane and w at the far one.
    tresses_projection[2] = 0.5 * (tresses_projection[3] - tresses_projection[2])
    return view.astype(np.float32), tresses_projection.astype(np.float32)


def render(simulation, view, projection, size, unit=1.0):
    """Return a picture [h, w, 4], linear and premultiplied, and Blender's window depth [h, w]; rows from the bottom."""
    camera = matrices(view, projection, unit)
    out = simulation.render(camera, size, ["color", "depth"], background="transparent", head="holdout")
    far = -out["depth"].astype(np.float64) / unit
    projection = np.array(projection, np.float64)
    has_depth = np.isfinite(far)
    z = np.where(has_depth, far, -1.0)
    clip, w = projection[2, 2] * z + projection[2, 3], projection[3, 2] * z + projection[3, 3]
    depth = np.where(has_depth, 0.5 + 0.5 * clip / w, 1.0)
    color = out["color"].astype(np.float32) / 255
    # Blender's framebuffer is linear. Alpha is already.
    tone = color[..., :3]
    color[..., :3] = np.where(tone <= 0.04045, tone / 12.92, ((tone + 0.055) / 1.055) ** 2.4)
    # A pixel without depth cannot be hidden behind an object.
    color[~has_depth] = 0
    return np.ascontiguousarray(color[::-1]), np.ascontiguousarray(depth[::-1].astype(np.float32))


def _program():
    global _shader
    if _shader is None:
        between = gpu.types.GPUStageInterfaceInfo("tresses_place")
        between.smooth("VEC2", "place")
        info = gpu.types.GPUShaderCreateInfo()
        info.vertex_in(0, "VEC2", "pos")
        info.vertex_out(between)
        info.sampler(0, "FLOAT_2D", "image")
        info.sampler(1, "FLOAT_2D", "depth")
        info.fragment_out(0, "VEC4", "color")
        # Blender 4.3 lacks this call, and its shaders write depth without it.
        if hasattr(info, "depth_write"):
            info.depth_write("ANY")
        info.vertex_source(VERTEX)
        info.fragment_source(FRAGMENT)
        _shader = gpu.shader.create_from_info(info)
    return _shader


def draw(color, depth):
    """Draw a picture with its depth over the current viewport."""
    height, width = depth.shape
    texture = lambda values, form: gpu.types.GPUTexture(
        (width, height), format=form, data=gpu.types.Buffer("FLOAT", values.size, values.ravel())
    )
    shader = _program()
    corners = batch_for_shader(shader, "TRI_STRIP", {"pos": [(-1, -1), (1, -1), (-1, 1), (1, 1)]})
    # A texture that nothing refers to is freed at once.
    textures = {"image": texture(color, "RGBA16F"), "depth": texture(depth, "R32F")}
    shader.bind()
    for name, bound in textures.items():
        shader.uniform_sampler(name, bound)
    gpu.state.blend_set("ALPHA_PREMULT")
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(True)
    corners.draw(shader)
    gpu.state.depth_mask_set(False)
    gpu.state.depth_test_set("NONE")
    gpu.state.blend_set("NONE")


def start(live):
    """Draw the hair of `live`, a simulation, in all 3D views, and its curves as boxes."""
    import bpy

    global _handle
    stop()

    def show():
        global _last
        region, data = bpy.context.region, bpy.context.region_data
        if data is None:
            return
        view, projection = np.array(data.view_matrix), np.array(data.window_matrix)
        state = (view.tobytes(), projection.tobytes(), region.width, region.height, live.frame)
        try:
            if _last is None or _last[0] != state:
                size = (region.width, region.height)
                _last = (state, render(live.simulation, view, projection, size, live.space.unit))
            draw(*_last[1])
        except Exception:
            # The curves must not stay boxes. Blender prints the error.
            stop(live)
            raise

    live.simulation.apply({"renderer.kind": "tiles", "renderer.ssaa": 1})
    for one in live.hair:
        one.object.display_type = "BOUNDS"
    _handle = bpy.types.SpaceView3D.draw_handler_add(show, (), "WINDOW", "POST_VIEW")


def stop(live=None):
    """End drawing, and show the curves again."""
    import bpy

    global _handle, _last, _shader
    if _handle is not None:
        bpy.types.SpaceView3D.draw_handler_remove(_handle, "WINDOW")
    # Blender frees its GPU before Python's modules: nothing of it may stay in them.
    _handle = _last = _shader = None
    for one in live.hair if live else ():
        one.object.display_type = "TEXTURED"
