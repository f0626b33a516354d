"""Settings of the scene and of its view layers, and the add-on's preferences."""

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

_METHODS = (
    ("auto", "Automatic", "Tries some of the others on a small picture, and takes one"),
    ("pt", "Path tracing", "Where lamps and sky are in plain sight"),
    ("bpt", "Bidirectional", "Where nothing is to be prepared"),
    ("lvcbpt", "Light vertex cache", "Joins eye vertices with random light vertices"),
    ("risbpt", "Resampled", "For glossy rooms and many lamps, without setup"),
    ("icbpt", "Importance records", "For dim rooms, without setup"),
    ("skelbpt", "Skeleton", "For halls and corridors; takes seconds to prepare"),
    ("spcbpt", "Subspaces", "For light that is hard to find; takes up to a minute to prepare"),
    ("sharebpt", "Shared walks", "As Subspaces, for surfaces that are not shiny; takes seconds to prepare"),
)


class LacunaScene(bpy.types.PropertyGroup):
    method: EnumProperty(name="Method", items=_METHODS, default="auto", description="How paths of light are found")
    samples: IntProperty(name="Samples", min=0, default=0, soft_max=65536,
                         description="Iterations, each with one path per pixel. 0: only the other limits count")
    seconds: FloatProperty(name="Time", min=0, default=60, soft_max=3600, unit="TIME_ABSOLUTE",
                           description="Seconds from the first sample on. 0: only the other limits count")
    error: FloatProperty(name="Error", min=0, max=100, default=0, precision=1, subtype="PERCENTAGE",
                         description="Stops once the picture's mean error is below this. 0: only the other limits count")
    depth: IntProperty(name="Depth", min=1, max=254, default=12,
                       description="Longest path, in edges: 1 shows only lights that the camera sees, 2 adds direct lighting")
    seed: IntProperty(name="Seed", min=0, default=1, description="Another seed gives other noise")
    baked: IntProperty(name="Baked textures", min=0, max=8192, default=1024,
                       description="Texels along a side of the image that a procedural texture becomes, for each input and "
                                   "object. 0: the colour beside the input is taken")
    animate_seed: BoolProperty(name="Other noise in each frame", default=True,
                               description="Adds the number of the frame to the seed")


class LacunaViewLayer(bpy.types.PropertyGroup):
    use_albedo: BoolProperty(name="Albedo", description="Colour of the surface that is seen first, for denoisers")
    use_variance: BoolProperty(name="Variance", description="Variance of each pixel's mean: how noisy it is")


class LacunaPreferences(bpy.types.AddonPreferences):
    bl_idname = __package__

    program: StringProperty(name="lacuna-render", subtype="FILE_PATH",
                            description="The program. Empty: the one in the PATH")

    def draw(self, context):
        self.layout.prop(self, "program")


_CLASSES = (LacunaScene, LacunaViewLayer, LacunaPreferences)


def register():
    for made in _CLASSES:
        bpy.utils.register_class(made)
    bpy.types.Scene.lacuna = PointerProperty(type=LacunaScene)
    bpy.types.ViewLayer.lacuna = PointerProperty(type=LacunaViewLayer)


def unregister():
    del bpy.types.ViewLayer.lacuna
    del bpy.types.Scene.lacuna
    for made in reversed(_CLASSES):
        bpy.utils.unregister_class(made)
