"""Renders the scene of glass.py with Cycles.

usage: blender -b --factory-startup --python tests/peers/blender.py -- OUT.exr SAMPLES SEED

One thread, 64 bounces, no clamping, no denoising, a box filter, roulette as Cycles has it by default. Its materials know
one index for each surface, so the scene is that of borders(): every border once, with the quotient of the two indices.
What a medium absorbs depends on how far a ray came through it; a surface's shader knows that length, and on which side
the ray was. Prints the processor's time of the rendering.
SPDX-License-Identifier: Apache-2.0
"""
import math
import os
import sys
import time

import bpy
from mathutils import Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import glass  # noqa: E402


def y_up(v):
    """Blender's z points up."""
    return (v[0], -v[2], v[1])


def add_mesh(name, mesh, material):
    data = bpy.data.meshes.new(name)
    data.from_pydata([y_up(v) for v in mesh.vertices], [], mesh.triangles)
    data.materials.append(material)
    data.update()
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    return made


def new_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    return material, material.node_tree.nodes, material.node_tree.links


def border_material(name, behind, front):
    """Glass BSDF takes the index as that of the side behind the normal over that of the front."""
    material, nodes, links = new_material(name)
    output, bsdf = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeBsdfGlass")
    bsdf.distribution = "SHARP"
    bsdf.inputs["Roughness"].default_value = 0
    bsdf.inputs["IOR"].default_value = glass.MEDIA[behind][0] / glass.MEDIA[front][0]
    bsdf.inputs["Color"].default_value = (1, 1, 1, 1)
    links.new(bsdf.outputs[0], output.inputs["Surface"])
    sigma_behind, sigma_front = glass.MEDIA[behind][1], glass.MEDIA[front][1]
    length, side = nodes.new("ShaderNodeLightPath").outputs["Ray Length"], nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"]

    def vector(operation, a, b=None, scale=None, c=None):
        node = nodes.new("ShaderNodeVectorMath")
        node.operation = operation
        for i, value in enumerate((a, b, c)):
            if value is None:
                continue
            if isinstance(value, tuple):
                node.inputs[i].default_value = value
            else:
                links.new(value, node.inputs[i])
        if scale is not None:
            links.new(scale, node.inputs["Scale"])
        return node.outputs[0]

    difference = tuple(f - b for b, f in zip(sigma_behind, sigma_front))
    # of the ray's own side, negative: -front + side * (front - behind)
    sigma = vector("ADD", vector("SCALE", difference, scale=side), tuple(-f for f in sigma_front))
    split = nodes.new("ShaderNodeSeparateXYZ")
    links.new(vector("SCALE", sigma, scale=length), split.inputs[0])
    joined = nodes.new("ShaderNodeCombineXYZ")
    for i in range(3):
        power = nodes.new("ShaderNodeMath")
        power.operation = "EXPONENT"
        links.new(split.outputs[i], power.inputs[0])
        links.new(power.outputs[0], joined.inputs[i])
    links.new(joined.outputs[0], bsdf.inputs["Color"])
    return material


def add_lamp():
    """A square that shines to one side; from its back it is black. Blender's area lights would let the sky through."""
    material, nodes, links = new_material("lamp")
    output, mix = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeMixShader")
    front, back = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeEmission")
    front.inputs["Strength"].default_value, back.inputs["Strength"].default_value = glass.LAMP["radiance"], 0
    links.new(nodes.new("ShaderNodeNewGeometry").outputs["Backfacing"], mix.inputs[0])
    links.new(front.outputs[0], mix.inputs[1])
    links.new(back.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], output.inputs["Surface"])
    add_mesh("lamp", glass.lamp(), material)


def build():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    for name, behind, front, mesh in glass.borders():
        add_mesh(name, mesh, border_material(name, behind, front))
    matte, nodes, links = new_material("table")
    output, bsdf = nodes.new("ShaderNodeOutputMaterial"), nodes.new("ShaderNodeBsdfDiffuse")
    bsdf.inputs["Color"].default_value = glass.TABLE_ALBEDO + (1,)
    links.new(bsdf.outputs[0], output.inputs["Surface"])
    add_mesh("table", glass.table(), matte)

    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = glass.SKY + (1,)

    add_lamp()

    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit, camera.angle = "HORIZONTAL", math.radians(glass.CAMERA["fov"])
    camera.clip_start, camera.clip_end = 1, 1e5
    placed = bpy.data.objects.new("camera", camera)
    bpy.context.scene.collection.objects.link(placed)
    look(placed, glass.CAMERA)
    bpy.context.scene.camera = placed


def look(placed, view):
    """Cameras and lights of Blender look along their own -z."""
    a, b = Vector(y_up(view["from"])), Vector(y_up(view["to"]))
    placed.location = a
    placed.rotation_euler = (b - a).to_track_quat("-Z", "Y").to_euler()


def settings(path, samples, seed):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x = scene.render.resolution_y = glass.SIZE
    scene.render.resolution_percentage = 100
    scene.render.filepath = os.path.abspath(path)
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.view_settings.view_transform = "Raw"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.seed = "CPU", samples, seed
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = glass.BOUNCES
    cycles.transmission_bounces = cycles.transparent_max_bounces = glass.BOUNCES
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy, cycles.light_sampling_threshold = 0, 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.pixel_filter_type = "BOX"
    cycles.use_auto_tile = False


def main():
    words = sys.argv[sys.argv.index("--") + 1:]
    build()
    settings(words[0], int(words[1]), int(words[2]))
    start = time.process_time()
    bpy.ops.render.render(write_still=True)
    print(f"peer: cycles {bpy.app.version_string} cpu {time.process_time() - start:.4f}")


main()
