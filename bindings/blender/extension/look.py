"""Materials of Blender's hair as fibers of Tresses."""

import numpy as np


def _shader(hair_object):
    """Return the Principled Hair BSDF of the first material that has one, or None."""
    for material in hair_object.data.materials:
        tree = getattr(material, "node_tree", None)
        for node in tree.nodes if tree else ():
            if node.bl_idname == "ShaderNodeBsdfHairPrincipled":
                return node
    return None


def fiber(hair_object):
    """Return the material of EXT_tresses_hair for a hair object; empty without melanin.

    Blender's absorption by melanin and its redness is that of Tresses' pigments within 0.04 %.
    """
    shader = _shader(hair_object)
    if shader is None or shader.parametrization != "MELANIN":
        return {}
    value = lambda name, default: float(shader.inputs[name].default_value) if name in shader.inputs else default
    melanin, redness = value("Melanin", 0.5), value("Melanin Redness", 0.5)
    amount = -np.log(max(1 - melanin, 1e-4))
    return {
        "eumelanin": 1.208 * amount * (1 - redness),
        "pheomelanin": 1.831 * amount * redness,
        "longitudinalRoughness": float(np.clip(value("Roughness", 0.3), 0.1, 1)),
        "azimuthalRoughness": float(np.clip(value("Radial Roughness", 0.3), 0.1, 1)),
        "ior": float(np.clip(value("IOR", 1.55), 1.05, 2.5)),
        "cuticleTilt": float(np.clip(value("Offset", 0.0349), -0.2, 0.2)),
    }


def settings(hair_object):
    """Return the same material as values of Tresses' parameters."""
    names = {
        "eumelanin": "shading.eumelanin",
        "pheomelanin": "shading.pheomelanin",
        "longitudinalRoughness": "shading.roughness_along",
        "azimuthalRoughness": "shading.roughness_around",
        "ior": "shading.refraction",
    }
    out = {names[name]: value for name, value in fiber(hair_object).items() if name in names}
    return {"shading.color": "melanin", **out} if out else {}
