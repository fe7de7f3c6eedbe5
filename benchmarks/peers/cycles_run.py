"""The scene rendered by Blender's Cycles; run by the Python of an environment that has `bpy`.

Reads the job as JSON from standard input and writes brightnesses as JSON to standard output. The
camera is the objective: its lens is the aperture, it is focused where the beam is, and its picture
is one point, so that each sample is a ray of octsim's beam, drawn at random. What shines is the
objective's disk, so that a brightness is the part of the light that returns to it.
"""

import json
import math
import sys
import tempfile
import time
from pathlib import Path

import bpy
import numpy as np

SIDES = 8192
"""Of the prism that stands for the cylinder, with its normals interpolated: Cycles has no other."""
PIXELS = 64


def material(name: str, index: float | None) -> object:
    """Make glass of a relative index, or, without one, what shines."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    nodes = made.node_tree.nodes
    nodes.clear()
    shader = nodes.new("ShaderNodeEmission" if index is None else "ShaderNodeBsdfGlass")
    if index is not None:
        shader.inputs["IOR"].default_value = index
        shader.inputs["Roughness"].default_value = 0
    output = nodes.new("ShaderNodeOutputMaterial")
    made.node_tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def build(job: dict) -> None:
    """Build scene and camera; a unit of Blender's is a µm."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    glass, water, neuron = job["indices"]
    floor = job["focus"] - job["focus_distance"]
    bpy.ops.mesh.primitive_plane_add(size=4000)
    bpy.context.object.data.materials.append(material("glass", glass / water))
    radius = job["diameter"] / 2
    bpy.ops.mesh.primitive_cylinder_add(
        vertices=SIDES, radius=radius, depth=2000, location=(0, 0, job["gap"] + radius),
        rotation=(math.pi / 2, 0, 0),
    )  # fmt: skip
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(material("neuron", neuron / water))
    bpy.ops.mesh.primitive_circle_add(
        vertices=4096,
        radius=job["objective_radius"],
        fill_type="NGON",
        location=(0, 0, floor - 0.01),
    )
    bpy.context.object.data.materials.append(material("objective", None))
    bpy.ops.object.camera_add(location=(0, 0, floor), rotation=(math.pi, 0, 0))
    camera = bpy.context.object
    bpy.context.scene.camera = camera
    camera.data.type, camera.data.ortho_scale = "ORTHO", 1e-6
    camera.data.clip_start, camera.data.clip_end = 1e-3, 1e4
    camera.data.dof.use_dof = True
    camera.data.dof.focus_distance = job["focus_distance"]
    camera.data.dof.aperture_fstop = 1 / (2 * job["objective_radius"])


def settings(meetings: int) -> None:
    """Have Cycles follow every path, on one thread, without what makes pictures smoother."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = PIXELS
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.device = "CPU"
    for kind in ("max", "glossy", "transmission", "diffuse"):
        setattr(cycles, f"{kind}_bounces", meetings + 1)
    cycles.min_light_bounces = meetings + 1
    cycles.blur_glossy = cycles.sample_clamp_indirect = cycles.sample_clamp_direct = 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.caustics_reflective = cycles.caustics_refractive = True


def render(samples: int, seed: int, picture: Path) -> tuple[float, float, float]:
    """Return the mean brightness, its standard error, and the seconds it took."""
    scene = bpy.context.scene
    scene.cycles.samples, scene.cycles.seed = samples, seed
    scene.render.filepath = str(picture)
    began = time.perf_counter()
    bpy.ops.render.render(write_still=True)
    seconds = time.perf_counter() - began
    image = bpy.data.images.load(str(picture))
    values = np.array(image.pixels[:]).reshape(-1, 4)[:, 0]
    bpy.data.images.remove(image)
    return float(values.mean()), float(values.std() / math.sqrt(values.size)), seconds


def main() -> None:
    """Do the job that standard input has."""
    job = json.load(sys.stdin)
    build(job)
    settings(job["meetings"])
    with tempfile.TemporaryDirectory() as folder:
        found = [
            dict(
                zip(
                    ("mean", "error", "seconds"),
                    render(samples, seed + 1, Path(folder) / f"{seed}.exr"),
                    strict=True,
                ),
                rays=samples * PIXELS**2,
            )
            for seed, samples in enumerate(job["samples"])
        ]
    print("RESULT " + json.dumps({"version": bpy.app.version_string, "results": found}))


if __name__ == "__main__":
    main()
