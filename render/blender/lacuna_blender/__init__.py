"""Lacuna as a render engine of Blender: exports the scene, runs lacuna-render, shows its pictures."""

bl_info = {
    "name": "Lacuna",
    "author": "The Lacuna team",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Render Engine",
    "description": "Renders with lacuna-render: light that is hard to find",
    "category": "Render",
}


def register():
    # Imported here, so that the parts that need no Blender can be tested without it.
    from . import engine, panels, properties

    properties.register()
    engine.register()
    panels.register()


def unregister():
    from . import engine, panels, properties

    panels.unregister()
    engine.unregister()
    properties.unregister()
