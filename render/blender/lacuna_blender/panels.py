"""Panels: the add-on's own, and those of Blender whose settings Lacuna uses."""

import bpy

from . import engine

# Panels of Eevee for lamps, materials and worlds that are not specific to Eevee.
_SHARED_OF_EEVEE = ("EEVEE_MATERIAL_PT_context_material", "EEVEE_MATERIAL_PT_surface", "EEVEE_WORLD_PT_surface",
                    "DATA_PT_EEVEE_light", "MATERIAL_PT_preview")
_NOT_OURS = ("VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes", "RENDER_PT_simplify")


class _Panel:
    bl_space_type, bl_region_type = "PROPERTIES", "WINDOW"
    COMPAT_ENGINES = {"LACUNA"}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES


class LACUNA_PT_sampling(_Panel, bpy.types.Panel):
    bl_label, bl_context = "Sampling", "render"

    def draw(self, context):
        layout, settings = self.layout, context.scene.lacuna
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.prop(settings, "method")
        limits = layout.column(align=True, heading="Until")
        limits.prop(settings, "seconds")
        limits.prop(settings, "samples")
        limits.prop(settings, "error")
        layout.prop(settings, "depth")
        layout.prop(settings, "seed")
        layout.prop(settings, "animate_seed")
        layout.prop(settings, "baked")


class LACUNA_PT_film(_Panel, bpy.types.Panel):
    bl_label, bl_context = "Film", "render"

    def draw(self, context):
        layout = self.layout
        layout.use_property_split, layout.use_property_decorate = True, False
        layout.prop(context.scene.render, "film_transparent", text="Transparent")


class LACUNA_PT_notes(_Panel, bpy.types.Panel):
    bl_label, bl_context = "Not Rendered as in Blender", "render"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and bool(engine.last_notes)

    def draw(self, context):
        for line in engine.last_notes:
            self.layout.label(text=line, icon="INFO")


class LACUNA_PT_passes(_Panel, bpy.types.Panel):
    bl_label, bl_context = "Passes", "view_layer"

    def draw(self, context):
        layout, layer = self.layout, context.view_layer
        layout.use_property_split, layout.use_property_decorate = True, False
        column = layout.column(heading="Data")
        column.prop(layer, "use_pass_z", text="Depth")
        column.prop(layer, "use_pass_normal", text="Normal")
        column.prop(layer, "use_pass_position", text="Position")
        column.prop(layer.lacuna, "use_albedo")
        column.prop(layer.lacuna, "use_variance")


_CLASSES = (LACUNA_PT_sampling, LACUNA_PT_film, LACUNA_PT_notes, LACUNA_PT_passes)


def _shared():
    for panel in bpy.types.Panel.__subclasses__():
        engines, name = getattr(panel, "COMPAT_ENGINES", ()), panel.__name__
        if ("BLENDER_RENDER" in engines and name not in _NOT_OURS) or name in _SHARED_OF_EEVEE:
            yield panel


def register():
    for made in _CLASSES:
        bpy.utils.register_class(made)
    for panel in _shared():
        panel.COMPAT_ENGINES.add("LACUNA")


def unregister():
    for panel in bpy.types.Panel.__subclasses__():
        if panel not in _CLASSES:
            getattr(panel, "COMPAT_ENGINES", set()).discard("LACUNA")
    for made in reversed(_CLASSES):
        bpy.utils.unregister_class(made)
