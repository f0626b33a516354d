"""What make_scenes.py is made of: meshes, building parts, pictures, the GLB writer, its validator, the scenes."""
