"""Near lights of the views of `truth`: their description in scenes.json, samples of them, and the views that they light.

Distances are in meters. No ray hits a light, and it hides nothing.
"""
import math

import numpy as np

# Near lights of a view of which each is sampled at each vertex of a path. Of more lights, this number is chosen.
FEW = 4
# Middle of the head: built-in, and of Sintel.
HEAD, SINTEL = np.array([0.0, 0.12, -0.02]), np.array([0.0, 1.56, -0.01])


def towards(azimuth, elevation):
    """Returns the unit vector at an azimuth from +Z towards +X and an elevation, in degrees."""
    a, e = math.radians(azimuth), math.radians(elevation)
    return np.array([math.sin(a) * math.cos(e), math.sin(e), math.cos(a) * math.cos(e)])


def unit(vector):
    return np.asarray(vector, float) / np.linalg.norm(vector)


def plain(vector):
    return [float(number) for number in vector]


def facing(center, target, width, height):
    """Returns center and half edges of an upright rectangle that faces a target."""
    front = unit(np.subtract(target, center))
    right = unit(np.cross((0, 1, 0), front))
    return dict(center=plain(center), right=plain(0.5 * width * right),
                up=plain(0.5 * height * np.cross(front, right)))


def point(position, intensity):
    return dict(kind="point", position=plain(position), intensity_rgb=plain(intensity))


def spot(position, target, inner, outer, intensity):
    return dict(kind="spot", position=plain(position), direction=plain(unit(np.subtract(target, position))),
                inner_degrees=inner, outer_degrees=outer, intensity_rgb=plain(intensity))


def rectangle(center, target, width, height, radiance):
    return dict(kind="rectangle", **facing(center, target, width, height), radiance_rgb=plain(radiance))


def ring(center, target, radius, hole, radiance):
    return dict(kind="disc", center=plain(center), direction=plain(unit(np.subtract(target, center))), radius=radius,
                hole=hole, radiance_rgb=plain(radiance))


def sphere(center, radius, radiance):
    return dict(kind="sphere", center=plain(center), radius=radius, radiance_rgb=plain(radiance))


def tube(begin, end, radius, radiance):
    return dict(kind="tube", ends=[plain(begin), plain(end)], radius=radius, radiance_rgb=plain(radiance))


def many(center, seed, count=32, irradiance=0.7):
    """Returns points around a center, 0.6 to 2 m away, that differ in color and strength."""
    random = np.random.default_rng(seed)
    lights = {}
    for number in range(count):
        distance = random.uniform(0.6, 2.0)
        color = np.array([1.0, 0.8, 0.55]) + random.uniform() * np.array([-0.45, 0.0, 0.45])
        position = center + distance * unit(random.normal(size=3))
        strength = irradiance * random.uniform(0.3, 1.7) * distance ** 2
        lights[f"point_{number + 1}"] = point(position, strength * color)
    return lights


def around(middle, azimuth, elevation, distance):
    """Returns the point at an azimuth from +Z towards +X, an elevation and a distance from `middle`."""
    return middle + distance * towards(azimuth, elevation)


def upright(middle, azimuth, distance, radiance):
    """Returns a vertical tube of a meter beside `middle`."""
    at = around(middle, azimuth, 0, distance)
    return tube(at - [0, 0.5, 0], at + [0, 0.5, 0], 0.013, radiance)


# Views lit from near: case, groom, pigment, azimuth and elevation of the camera, sky, lights. Positions in meters, in the
# space of the groom. These six are used while near lights are developed.
NEAR_TUNED = [
    ("temple", "curly", "brown", 55, 4, True, {"lamp": sphere((0.226, 0.13, 0.03), 0.02, (320, 300, 270))}),
    ("rectangle", "curly", "blond", -30, 5, False,
     {"panel": rectangle(around(HEAD, -70, 25, 0.8), HEAD, 0.6, 0.6, (20, 19, 17))}),
    ("spot", "bob", "red", -50, 6, True,
     {"spot": spot(around(HEAD, -75, 20, 0.6), (-0.09, 0.13, -0.01), 5, 7, (4.4, 4.2, 3.8))}),
    ("tubes", "long", "blond", 20, 4, False,
     {"left": upright(HEAD, -75, 0.5, (120, 25, 75)), "right": upright(HEAD, 70, 0.5, (12, 75, 110))}),
    ("shoulder", "long", "brown", -65, 5, True, {"lamp": sphere((-0.1, -0.04, -0.03), 0.006, (310, 280, 230))}),
    ("many", "bob", "brown", 30, 8, False, many(HEAD, 70)),
]
# These are rendered once, when parameters are final.
NEAR_HELD = [
    ("behind", "bob", "blond", -20, 5, False, {"lamp": point(around(HEAD, 165, 10, 0.3), (0.8, 0.77, 0.7))}),
    ("ring", "long", "red", 25, 3, True,
     {"ring": ring(around([0, 0.06, -0.02], 25, 3, 0.6), (0, 0.06, -0.02), 0.175, 0.125, (60, 58, 54))}),
    ("lamp", "sintel", "brown", -50, 6, False, {"lamp": point(around(SINTEL, -100, 15, 0.4), (1.45, 1.35, 1.15))}),
    ("spot", "sintel", "blond", 120, 5, True,
     {"spot": spot(around(SINTEL, 150, 25, 0.7), (0.04, 1.58, -0.05), 5, 7.5, (5.9, 5.8, 5.6))}),
    ("temple", "curly", "black", -120, 6, True, {"lamp": sphere((-0.226, 0.13, 0.0), 0.02, (210, 200, 185))}),
    ("rectangle", "long", "brown", 70, 5, False,
     {"panel": rectangle(around(HEAD, 150, 10, 0.8), HEAD, 0.6, 0.6, (14, 14, 15))}),
]
# Nine heads and a light at their height, beside them. It is aside of the rows, so that heads lie in each other's shadow
# to different degrees.
COPIES = [(0.55 * x, 0.0, 0.55 * z) for z in (-1, 0, 1) for x in (-1, 0, 1)]
CROWD = [
    ("nine", "crowd", "brown", -50, 35, False, {"lamp": sphere((-1.35, 0.12, 0.2), 0.03, (5200, 5000, 4600))}),
]


def sample(light, at, random):
    """Returns a random point of a light, and what it contributes to the irradiance of a surface at `at` that faces it.
    `random` is a pair of numbers from 0 to 1. Areas are sampled evenly, spheres by their solid angle."""
    import drjit as dr
    import mitsuba as mi

    kind, vector = light["kind"], lambda name: mi.Vector3f(light[name])
    if kind in ("point", "spot"):
        place, strength = mi.Point3f(light["position"]), mi.Color3f(light["intensity_rgb"])
        away = at - place
        if kind == "spot":
            # The falloff of glTF's KHR_lights_punctual.
            inner, outer = (math.cos(math.radians(light[f"{name}_degrees"])) for name in ("inner", "outer"))
            inside = (dr.dot(away, vector("direction")) / dr.norm(away) - outer) / max(inner - outer, 1e-4)
            strength = strength * dr.clip(inside, 0, 1) ** 2
        return place, strength / dr.squared_norm(away)
    radiance = mi.Color3f(light["radiance_rgb"])
    if kind == "sphere":
        to_center, square = mi.Vector3f(light["center"]) - at, light["radius"] ** 2
        distance = dr.norm(to_center)
        sine = dr.minimum(square / distance ** 2, 1)
        # The widest angle: 1 - cosine, without cancellation.
        widest = sine / (1 + dr.sqrt(1 - sine))
        less = random.x * widest
        squared = less * (2 - less)
        frame = mi.Frame3f(to_center / distance)
        across = dr.sqrt(squared)
        direction = frame.to_world(mi.Vector3f(across * dr.cos(dr.two_pi * random.y),
                                               across * dr.sin(dr.two_pi * random.y), 1 - less))
        depth = distance * (1 - less) - dr.safe_sqrt(square - distance ** 2 * squared)
        return at + depth * direction, radiance * dr.select(distance > light["radius"], dr.two_pi * widest, 0)
    if kind == "rectangle":
        right, up = np.array(light["right"]), np.array(light["up"])
        normal, area = mi.Vector3f(unit(np.cross(right, up)).tolist()), 4 * float(np.linalg.norm(np.cross(right, up)))
        place = mi.Point3f(light["center"]) + vector("right") * (2 * random.x - 1) + vector("up") * (2 * random.y - 1)
    elif kind == "disc":
        normal, squares = vector("direction"), (light["hole"] ** 2, light["radius"] ** 2)
        area = math.pi * (squares[1] - squares[0])
        radius = dr.sqrt(squares[0] + (squares[1] - squares[0]) * random.x)
        angle = dr.two_pi * random.y
        frame = mi.Frame3f(normal)
        place = mi.Point3f(light["center"]) + frame.to_world(
            mi.Vector3f(radius * dr.cos(angle), radius * dr.sin(angle), 0))
    elif kind == "tube":
        begin, end = (np.array(end, float) for end in light["ends"])
        along, radius = mi.Vector3f(unit(end - begin).tolist()), light["radius"]
        beside = at - mi.Point3f(begin.tolist())
        beside -= along * dr.dot(beside, along)
        height = dr.norm(beside)
        # The visible part of the circumference.
        widest = dr.safe_acos(radius / height)
        angle = widest * (2 * random.y - 1)
        beside /= height
        normal = beside * dr.cos(angle) + dr.cross(along, beside) * dr.sin(angle)
        area = 2 * widest * radius * float(np.linalg.norm(end - begin))
        place = mi.Point3f(begin.tolist()) + mi.Vector3f((end - begin).tolist()) * random.x + radius * normal
    away = at - place
    square = dr.squared_norm(away)
    return place, radiance * (area * dr.maximum(dr.dot(normal, away), 0) / (square * dr.sqrt(square)))


def choose(lights, at, random):
    """Returns the position of one of several points, chosen by their irradiance at `at`, and the irradiance divided by
    the probability of the choice. `random` is a number from 0 to 1."""
    import drjit as dr
    import mitsuba as mi

    rows = []
    for light in lights:
        place, strength = mi.Point3f(light["position"]), mi.Color3f(light["intensity_rgb"])
        irradiance = strength / dr.squared_norm(at - place)
        rows.append((place, irradiance, max(light["intensity_rgb"]) / dr.squared_norm(at - place)))
    total = sum(weight for _, _, weight in rows)
    begin = rows[0][2]
    place, arrives, chance = rows[0]
    for next_place, next_arrives, weight in rows[1:]:
        is_later = random * total >= begin
        place, arrives = dr.select(is_later, next_place, place), dr.select(is_later, next_arrives, arrives)
        chance = dr.select(is_later, weight, chance)
        begin = begin + weight
    return place, arrives * (total / chance)


def check():
    """Compares the irradiance of sampled lights on a floor, partly in shadow, with that of Mitsuba's emitters. Needs the
    integrator `split`."""
    import mitsuba as mi

    transform = mi.ScalarTransform4f
    floor = dict(type="rectangle", to_world=transform().rotate([1, 0, 0], -90),
                 bsdf=dict(type="diffuse", reflectance=dict(type="rgb", value=0.5)))
    black = dict(type="diffuse", reflectance=dict(type="rgb", value=0.0))
    shade = dict(type="sphere", center=[0.1, 0.15, 0.1], radius=0.1, bsdf=black)
    film = dict(type="hdrfilm", width=32, height=32, pixel_format="rgba", component_format="float32",
                rfilter=dict(type="box"))
    sensor = dict(type="perspective", fov=40, to_world=transform().look_at([0, 2, 0.01], [0, 0, 0], [0, 0, -1]), film=film)
    base = dict(type="scene", floor=floor, shade=shade, sensor=sensor)
    emits = lambda light: dict(type="area", radiance=dict(type="rgb", value=light["radiance_rgb"]))
    color = lambda light: dict(type="rgb", value=light["intensity_rgb"])

    def disc(light, radius):
        place = transform().look_at(light["center"], plain(np.add(light["center"], light["direction"])), [1, 0, 0])
        return dict(type="disk", to_world=place.scale(radius), emitter=emits(light))

    def emitters(light):
        """Returns Mitsuba's emitters whose sum, with these weights, is the light."""
        kind = light["kind"]
        if kind == "point":
            return [(1, dict(type="point", position=light["position"], intensity=color(light)))]
        if kind == "spot":
            place = transform().look_at(light["position"], plain(np.add(light["position"], light["direction"])), [1, 0, 0])
            return [(1, dict(type="spot", to_world=place, intensity=color(light), cutoff_angle=light["outer_degrees"],
                             beam_width=light["inner_degrees"]))]
        if kind == "sphere":
            return [(1, dict(type="sphere", center=light["center"], radius=light["radius"], emitter=emits(light)))]
        if kind == "tube":
            return [(1, dict(type="cylinder", p0=light["ends"][0], p1=light["ends"][1], radius=light["radius"],
                             emitter=emits(light)))]
        if kind == "disc":
            return [(1, disc(light, light["radius"])), (-1, disc(light, light["hole"]))]
        right, up = np.array(light["right"]), np.array(light["up"])
        place = np.eye(4)
        place[:3] = np.stack([right, up, unit(np.cross(right, up)), light["center"]], -1)
        return [(1, dict(type="rectangle", to_world=transform(place), emitter=emits(light)))]

    aside = [0.9, 0.8, -0.3]
    cases = {
        "point": [point(aside, (3, 2, 1))],
        # Mitsuba's falloff is another one, so the cone has a hard edge.
        "spot": [spot(aside, (0, 0, 0), 14.99, 15, (3, 2, 1))],
        "sphere": [sphere(aside, 0.2, (9, 6, 3))],
        "rectangle": [rectangle(aside, (0, 0, 0), 0.6, 0.4, (9, 6, 3))],
        "ring": [ring(aside, (0, 0, 0), 0.4, 0.3, (9, 6, 3))],
        "tube": [tube(aside, (0.5, 0.4, 0.9), 0.05, (9, 6, 3))],
        "many points": list(many(np.array([0.0, 2.5, 0.0]), 1, 12).values()),
    }
    spp = 16384
    for name, lights in cases.items():
        expected = 0
        for weight, emitter in (pair for light in lights for pair in emitters(light)):
            what = mi.load_dict(base | dict(lamp=emitter, integrator=dict(type="path", max_depth=2)))
            expected = expected + weight * np.array(mi.render(what, spp=spp, seed=1), float)[..., :3]
        what = mi.load_dict(base | dict(integrator=dict(type="split")))
        tracer = what.integrator()
        tracer.near, tracer.sky = lights, lambda direction: 0.0
        found = np.array(mi.render(what, integrator=tracer, spp=spp, seed=2), float)[..., :3]
        blocks = lambda image: image.reshape(8, 4, 8, 4, 3).mean((1, 3))
        worst = np.abs(blocks(found) - blocks(expected)).max() / blocks(expected).max()
        total = found.sum() / expected.sum()
        print(f"{name}: {total:.4f} of the light, {100 * worst:.2f} % off in a block of pixels")
        if abs(total - 1) > 0.005 or worst > 0.01:
            raise SystemExit(f"truth: {name} differs from Mitsuba's emitter")
