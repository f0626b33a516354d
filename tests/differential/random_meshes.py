"""Random meshes and the nodes that place them: all that the loader reads of them."""

import math

from gltf_writer import BYTE, FLOAT, SHORT, UNSIGNED_BYTE, UNSIGNED_INT, UNSIGNED_SHORT
from random_materials import Materials
from shapes import box, disc, quad, sphere, splinters


class Meshes(Materials):
    """Adds meshes and nodes to `gltf`; `roots` collects the nodes of the scene, `unit` is its length of 1."""

    def shape(self):
        r = self.r
        return r.choice((box, box, lambda: sphere(r.randint(4, 12), r.randint(3, 8)), lambda: sphere(10, 6), quad,
                         lambda: disc(r.randint(3, 8)), lambda: splinters(r, r.randint(1, 5))))()

    def positions(self, mesh):
        points = [tuple(map(float, p)) for p in mesh.points]
        whole = all(abs(x) in (0.0, 1.0) for p in points for x in p)
        kind = self.r.random()
        if kind < 0.15:
            self.used.add("KHR_mesh_quantization")
            return self.gltf.accessor(points, self.r.choice((BYTE, SHORT) if whole else (SHORT,)), True)
        if kind < 0.25 and whole:
            self.used.add("KHR_mesh_quantization")
            return self.gltf.accessor([tuple(map(int, p)) for p in points], self.r.choice((BYTE, SHORT)))
        return self.gltf.accessor(points, gap=self.r.choice((0, 0, 4, 12)), sparse=self.chance(0.15))

    def attributes(self, mesh):
        r, gltf = self.r, self.gltf
        found = {"POSITION": self.positions(mesh)}
        if self.chance(0.6):
            normals = list(mesh.normals)
            if self.chance(0.1):
                normals[r.randrange(len(normals))] = (0, 0, 0)
            if self.chance(0.1):  # bent against the faces
                normals = [tuple(x + r.gauss(0, 0.4) for x in n) for n in normals]
            lengths = [math.hypot(*n) or 1 for n in normals]
            normals = [tuple(x / l for x in n) for n, l in zip(normals, lengths)]
            form = self.mostly((FLOAT, False), lambda: (r.choice((BYTE, SHORT)), True), 0.7)
            found["NORMAL"] = gltf.accessor(normals, *form)
            if self.chance(0.4):
                found["TANGENT"] = gltf.accessor([(*self.tangent(n), r.choice((-1.0, 1.0))) for n in normals])
        for name in ("TEXCOORD_0", "TEXCOORD_1"):
            if self.chance(0.8 if name == "TEXCOORD_0" else 0.4):
                turn = r.random() if name == "TEXCOORD_1" else 0
                places = [(u * (1 - turn) + v * turn, v * (1 - turn) + u * turn) for u, v in mesh.places]
                form = self.mostly((FLOAT, False), lambda: (r.choice((UNSIGNED_BYTE, UNSIGNED_SHORT)), True), 0.7)
                found[name] = gltf.accessor(places, *form)
        if self.chance(0.25):
            size = r.choice((3, 4))
            form = r.choice(((FLOAT, False), (UNSIGNED_BYTE, True), (UNSIGNED_SHORT, True)))
            found["COLOR_0"] = gltf.accessor([tuple(r.uniform(0.2, 1) for _ in range(size)) for _ in mesh.points], *form)
        return found

    def tangent(self, normal):
        d = self.direction()
        along = sum(a * b for a, b in zip(d, normal))
        t = [a - along * b for a, b in zip(d, normal)]
        length = math.hypot(*t) or 1
        return [x / length for x in t]

    def mesh(self, shape, material):
        """Adds a mesh of one or two primitives. No lamp lies where another surface does: which of the two a ray meets
        would be chance."""
        primitives = []
        for part in range(self.mostly(1, lambda: 2, 0.9)):
            if part:
                shape, material = splinters(self.r, 2), self.material()
            primitive = {"attributes": self.attributes(shape)}
            self.faces(shape, primitive, material)
            if material is not None:
                primitive["material"] = material
            if self.chance(0.03):
                primitive["targets"] = [{"POSITION": self.gltf.accessor([(0.0, 0.0, 0.0)] * len(shape.points))}]
            primitives.append(primitive)
        if self.chance(0.03):
            primitives.append({"mode": self.r.choice((0, 1)), "attributes": primitives[0]["attributes"]})
        return self.gltf.add("meshes", {"primitives": primitives})

    def faces(self, shape, primitive, material):
        r, gltf = self.r, self.gltf
        small = r.choice((UNSIGNED_BYTE, UNSIGNED_SHORT, UNSIGNED_INT))
        if shape.strip and self.chance(0.6):
            primitive["mode"] = shape.mode
            if self.chance(0.3):
                primitive["indices"] = gltf.accessor([(i,) for i in shape.strip], small)
            return
        triangles = list(shape.triangles)
        r.shuffle(triangles)
        if self.chance(0.1):
            triangles += [(0, 0, 1), (2, 2, 2)]
            if material is None or "emissiveFactor" not in gltf.root["materials"][material]:
                triangles.append(triangles[0])  # which lies there twice
        if self.chance(0.5):
            primitive["mode"] = 4
        if len(shape.points) == 3 * len(triangles) and self.chance(0.5):
            return
        primitive["indices"] = gltf.accessor([(i,) for t in triangles for i in t], small)

    def node(self, node, root=True):
        index = self.gltf.add("nodes", node)
        if root:
            self.roots.append(index)
        return index

    def place(self, centre, sizes, turned=True):
        """A node's transform: by parts or as a matrix."""
        centre = [x * self.unit for x in centre]
        sizes = [x * self.unit for x in sizes]
        q = self.quaternion() if turned else [0, 0, 0, 1]
        if self.chance(0.6):
            node = {"translation": centre, "scale": sizes}
            if turned:
                node["rotation"] = q
            return node
        l = math.hypot(*q)
        x, y, z, w = (c / l for c in q)
        columns = ((1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
                   (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
                   (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)))
        matrix = [c * s for column, s in zip(columns, sizes) for c in (*column, 0)]
        return {"matrix": [*matrix, *centre, 1]}

    def put(self, shape, material, centre, sizes, turned=True):
        """Places a mesh, by a node of its own, under a parent, or as several copies."""
        r = self.r
        node = {"mesh": self.mesh(shape, material), **self.place(centre, sizes, turned)}
        if self.chance(0.1):
            node["extras"] = {"lacuna": {"light_group": "of a node"}}
        if self.chance(0.15):
            self.copies(node)
        if self.chance(0.05):
            node["skin"] = self.gltf.add("skins", {"joints": [0]})
        child = self.node(node, root=False)
        if self.chance(0.3):
            parent = {"children": [child], "scale": [r.choice((-1, 1)) * r.uniform(0.8, 1.2) for _ in range(3)]}
            self.node(parent)
        else:
            self.roots.append(child)
        if self.chance(0.15):  # linked: the same mesh elsewhere, mirrored perhaps
            self.node({"mesh": node["mesh"], **self.place([r.uniform(-0.6, 0.6) for _ in range(3)],
                                                          [r.choice((-1, 1)) * s for s in sizes])})

    def copies(self, node):
        count = self.r.randint(1, 3)
        attributes = {}
        if count > 1 or self.chance(0.5):
            moves = [tuple(self.r.uniform(-1.5, 1.5) for _ in range(3)) for _ in range(count)]
            attributes["TRANSLATION"] = self.gltf.accessor(moves)
        if self.chance(0.6):
            attributes["ROTATION"] = self.gltf.accessor([tuple(self.quaternion()) for _ in range(count)])
        if self.chance(0.6) or not attributes:
            sizes = [tuple(self.r.choice((-1, 1, 1)) * self.r.uniform(0.5, 1) for _ in range(3)) for _ in range(count)]
            attributes["SCALE"] = self.gltf.accessor(sizes)
        node.setdefault("extensions", {})["EXT_mesh_gpu_instancing"] = {"attributes": attributes}
        self.used.add("EXT_mesh_gpu_instancing")
