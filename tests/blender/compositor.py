"""Run by Blender: compares a compositor graph with NumPy on the same channels. The graph loads an .exr of lacuna-render
with light groups and Cryptomatte, changes two lamps, and cuts out one object.
blender -b --factory-startup --python-exit-code 1 -P compositor.py -- PICTURE.exr CHANNELS.exr DIR
CHANNELS.exr holds the same channels in a form that the add-on's reader reads: one part of 32-bit floats."""
import os
import sys

import bpy
import numpy

here = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [here, os.path.join(here, "..", "..", "render", "blender")]
from cryptomatte import Cryptomatte  # noqa: E402
from lacuna_blender import exr  # noqa: E402

OBJECT, FACTORS = "enamel ring", {"panel": (2.0, 1.5, 1.0), "environment": (0.25, 0.25, 0.5)}


class Graph:
    def __init__(self, scene):
        scene.use_nodes = True
        self.tree = scene.node_tree
        self.tree.nodes.clear()

    def node(self, kind, **members):
        node = self.tree.nodes.new(kind)
        for name, value in members.items():
            setattr(node, name, value)
        return node

    def mix(self, blend, a, b):
        node = self.node("CompositorNodeMixRGB", blend_type=blend)
        node.inputs[0].default_value = 1
        for place, value in ((1, a), (2, b)):
            if isinstance(value, tuple):
                node.inputs[place].default_value = (*value, 1)
            else:
                self.tree.links.new(value, node.inputs[place])
        return node.outputs[0]


def composed(path, folder):
    """The picture that Blender renders of the graph."""
    scene = bpy.context.scene
    graph = Graph(scene)
    image = bpy.data.images.load(path)
    layers = graph.node("CompositorNodeImage", image=image)
    layers.layer = "light"
    outputs = {output.name: output for output in layers.outputs}
    lamps = [graph.mix("MULTIPLY", outputs[name], factor) for name, factor in FACTORS.items()]
    matte = graph.node("CompositorNodeCryptomatteV2", source="IMAGE", image=image)
    matte.layer_name = "CryptoObject"
    matte.matte_id = OBJECT
    cut = graph.mix("MULTIPLY", graph.mix("ADD", *lamps), matte.outputs["Matte"])
    graph.tree.links.new(cut, graph.node("CompositorNodeComposite").inputs[0])

    render = scene.render
    render.resolution_percentage = 100
    render.resolution_x, render.resolution_y = SIZE
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "ZIP"
    render.filepath = os.path.join(folder, "composed.exr")
    bpy.ops.render.render(write_still=True)
    return exr.read(render.filepath).stack("R", "G", "B")


picture, channels, folder = sys.argv[sys.argv.index("--") + 1:]
read = exr.read(channels)
SIZE = read.width, read.height
objects = Cryptomatte(read.channels, read.header, "CryptoObject")
matte = objects.matte(OBJECT)
assert matte.max() == 1 and 0.02 < matte.mean() < 0.3, matte.mean()
assert ((matte > 0) & (matte < 1)).sum() > 20, "no edges"
expected = sum(numpy.array(factor, numpy.float32) * read.stack(*("light.%s.%s" % (name, c) for c in "RGB"))
               for name, factor in FACTORS.items()) * matte[..., None]
assert expected.max() > 0.1
made = composed(picture, folder)
numpy.testing.assert_allclose(made, expected, rtol=2e-3 if picture != channels else 1e-5, atol=1e-6)
print("composed as expected: the matte of %s covers %.1f %%" % (OBJECT, 100 * matte.mean()))
