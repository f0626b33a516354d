"""The parts of make_scenes.py: meshes, building parts, pictures, the GLB writer, its validator, the scenes."""
