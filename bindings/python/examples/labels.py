"""Write a data set of hair in the wind: color, depth, tangents, motion and strand labels of each frame.

    python labels.py out/ --style long --frames 3
"""

import argparse
import pathlib

import numpy as np

import tresses

OUTPUTS = ["color", "linear", "coverage", "depth", "motion", "strand", "tangent"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--style", default="long")
    parser.add_argument("--strands", type=int, default=20_000)
    parser.add_argument("--frames", type=int, default=3)
    parser.add_argument("--size", type=int, default=480)
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)

    groom = tresses.Groom.built_in(args.style, {"style.strands": args.strands})
    sim = tresses.Simulation(groom)
    motion = tresses.Motion("shake")
    for frame in range(args.frames):
        for step in range(6):
            time = (6 * frame + step + 1) / 60
            sim.step(1 / 60, wind=[-6, 0, -2], **motion.at(time, sim.pivot))
        out = sim.render("three-quarter", (args.size, args.size), OUTPUTS)
        np.savez_compressed(args.out / f"{frame:04}.npz", guides=sim.guides(), **out)
        save(args.out / f"{frame:04}.png", sheet(out))


def sheet(out):
    """Return the outputs side by side as one color image."""
    hair = out["coverage"][..., None]
    depth = np.where(np.isfinite(out["depth"]), out["depth"], np.nan)
    near, far = np.nanmin(depth), np.nanmax(depth)
    shades = np.nan_to_num((far - depth) / max(far - near, 1e-6))[..., None].repeat(3, axis=2)
    hues = np.random.default_rng(0).random((out["strand"].max() + 2, 3))
    hues[-1] = 0  # background
    motion = np.nan_to_num(out["motion"]) / 8
    motion_colors = np.dstack([0.5 + motion, np.full(motion.shape[:2], 0.5)]) * hair
    parts = [out["color"][..., :3] / 255, shades, 0.5 * (out["tangent"] + 1) * hair, hues[out["strand"]], motion_colors]
    return (255 * np.clip(np.hstack(parts), 0, 1)).astype(np.uint8)


def save(path, picture):
    try:
        from PIL import Image
    except ImportError:
        return
    Image.fromarray(picture).save(path)


if __name__ == "__main__":
    main()
