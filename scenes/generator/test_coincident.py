"""Tests which faces count as coincident: python3 -B -m unittest discover -s scenes -t scenes"""

from __future__ import annotations

import unittest

from .building import X, Y, boxes, slab
from .coincident import coincident_faces, placed_triangles
from .glb import SceneFile
from .materials import lambert
from .mesh import Mesh, box, quad
from .validate import Glb
from .vector import about


def shared_area(*things: tuple[Mesh, dict]) -> float:
    """The shared area of all pairs of faces, in square metres, after writing and reading a file."""
    s = SceneFile("test", "meshes as given", 64, 64)
    grey = s.material(lambert("grey", (0.5, 0.5, 0.5)))
    for i, (mesh, placing) in enumerate(things):
        s.add(f"thing {i}", mesh, grey, **placing)
    s.camera((0.0, 0.0, 5.0), (0.0, 0.0, 0.0), 40.0)
    return sum(area for area, _ in coincident_faces(list(placed_triangles(Glb(s.glb())))).values())


class CoincidentFaces(unittest.TestCase):
    square = quad((0, 0, 0), (1, 0, 0), (0, 1, 0))

    def test_squares_that_overlap_by_a_quarter(self) -> None:
        self.assertAlmostEqual(shared_area((self.square, {}), (self.square, {"at": (0.5, 0.5, 0.0)})), 0.25, 5)

    def test_the_same_in_any_plane(self) -> None:
        for axis, degrees in (((1, 2, 3), 50), ((-3, 1, 0), 130), ((0, 1, 0), 90)):
            turned = about(axis, degrees)
            with self.subTest(axis=axis):
                self.assertAlmostEqual(shared_area((self.square, {"turned": turned}), (self.square, {"turned": turned})), 1.0, 4)

    def test_a_frame_in_its_opening_cut_to_measure(self) -> None:
        # A post beside an opening that is cut to measure: the wall's reveal lies in the post's face.
        wall = slab((0, 0, 0), X, Y, 3.0, 2.5, 0.14, [(1.0, 2.0, -0.1, 2.0)])
        post = box((0.94, -0.01, -0.15), (1.0, 2.0, 0.015))
        self.assertAlmostEqual(shared_area((wall, {}), (post, {})), 0.14 * 2.0, 4)

    def test_what_touches_stands_apart_or_crosses_has_nothing_in_common(self) -> None:
        for second in ({"at": (1.0, 0.0, 0.0)}, {"at": (0.0, 0.0, 0.002)}, {"turned": about((1, 0, 0), 30)}):
            with self.subTest(second=second):
                self.assertEqual(shared_area((self.square, {}), (self.square, second)), 0.0)
        stacked = boxes(((0, 0, 0), (1, 1, 1)), ((0.2, 1, 0.2), (0.8, 2, 0.8)))
        self.assertEqual(shared_area((stacked, {})), 0.0)


if __name__ == "__main__":
    unittest.main()
