"""A named mesh and what several checks ask of it, each computed once."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from core.geometry.adjacency import Edges, edges
from core.geometry.coincidence import group_equal_faces
from core.geometry.components import face_components, find_split_vertices
from core.geometry.containment import find_crossings
from core.geometry.degenerate import find_degenerate_faces
from core.geometry.dihedral import dihedral_angles
from core.geometry.exact_intersection import Pairs, find_intersecting_faces
from core.geometry.face_tree import FaceTree
from core.geometry.orientation import find_inconsistent_edges
from core.geometry.quality import quality
from core.geometry.volume import signed_volumes
from core.mesh import Mesh

Ints = NDArray[np.int64]


class Surface:
    """What is known of one mesh.

    Edges, components and fans are those of the `proper` faces: a face that repeats a corner is a line or a point and
    joins nothing; it is reported as degenerate. `face_number` leads from them to the face numbers of the mesh.
    """

    def __init__(self, name: str, mesh: Mesh, intersecting: Pairs | None = None) -> None:
        """`intersecting`: pairs of faces of this mesh (K, 2) that are known already from a call on a whole set."""
        self.name = name
        self.mesh = mesh
        if intersecting is not None:
            self.__dict__["intersecting"] = intersecting

    @cached_property
    def intersecting(self) -> Pairs:
        """Pairs of faces that meet other than in shared corners and edges, (K, 2)."""
        return find_intersecting_faces(self.mesh.vertices, self.mesh.faces)

    @cached_property
    def face_number(self) -> Ints:
        """Numbers of the proper faces, (P,)."""
        a, b, c = self.mesh.faces.T
        return np.flatnonzero((a != b) & (b != c) & (c != a))

    @cached_property
    def proper(self) -> NDArray[np.int32]:
        """Faces with three different corners, (P, 3)."""
        return self.mesh.faces[self.face_number]

    @cached_property
    def edges(self) -> Edges:
        """Edges of the proper faces."""
        return edges(self.proper)

    @cached_property
    def _components(self) -> tuple[int, Ints]:
        return face_components(self.edges)

    @property
    def component_count(self) -> int:
        """Pieces that hang together by edges."""
        return self._components[0]

    @property
    def component(self) -> Ints:
        """Piece of each proper face, (P,)."""
        return self._components[1]

    @cached_property
    def component_vertex(self) -> Ints:
        """One vertex of each piece, (components,)."""
        first = np.unique(self.component, return_index=True)[1]
        vertices: Ints = self.proper[first, 0].astype(np.int64)
        return vertices

    @cached_property
    def closed(self) -> bool:
        """Every edge has exactly two faces."""
        return len(self.proper) > 0 and bool((self.edges.face_count == 2).all())

    @cached_property
    def edge_manifold(self) -> bool:
        """No edge has more than two faces."""
        return bool((self.edges.face_count <= 2).all())

    @cached_property
    def split_vertices(self) -> Ints:
        """Vertices whose faces form several fans, (K,)."""
        return find_split_vertices(self.proper, self.edges)

    @cached_property
    def manifold(self) -> bool:
        """Edge- and vertex-manifold."""
        return self.edge_manifold and len(self.split_vertices) == 0

    @cached_property
    def inconsistent_edges(self) -> tuple[Ints, Ints]:
        """Edges whose two faces disagree about the outside: edge (K,), proper faces (K, 2)."""
        return find_inconsistent_edges(self.edges)

    @cached_property
    def consistent(self) -> bool:
        """No two neighbours disagree about the outside."""
        return len(self.inconsistent_edges[0]) == 0

    @cached_property
    def degenerate(self) -> Ints:
        """Faces of exactly zero area, (K,)."""
        return find_degenerate_faces(self.mesh.vertices, self.mesh.faces)

    @cached_property
    def duplicates(self) -> Ints:
        """Proper faces over the same three vertices as an earlier one, (K,) numbers of the mesh."""
        groups = group_equal_faces(self.proper)
        later: Ints = self.face_number[groups != np.arange(len(groups))]
        return later

    @cached_property
    def quality(self) -> NDArray[np.float64]:
        """Quality q of each face of the mesh, (F,)."""
        return quality(self.mesh.vertices, self.mesh.faces)

    @cached_property
    def dihedral(self) -> tuple[Ints, Ints, NDArray[np.float64]]:
        """Edges between two faces, the proper faces there (N, 2), and the angle between them in degrees."""
        return dihedral_angles(self.mesh.vertices, self.proper, self.edges)

    @cached_property
    def tree(self) -> FaceTree:
        """Boxes over all faces."""
        return FaceTree.of(self.mesh.vertices, self.mesh.faces)

    @cached_property
    def component_volumes(self) -> NDArray[np.float64]:
        """Signed volume of each piece in mm³; says something only if closed and consistent."""
        return signed_volumes(self.mesh.vertices, self.proper, self.component)

    @cached_property
    def component_depths(self) -> Ints:
        """How many other pieces hold each piece: odd for a cavity. Needs a closed mesh whose pieces do not intersect."""
        if self.component_count == 1:
            return np.zeros(1, dtype=np.int64)
        asked, face = find_crossings(self.tree, self.mesh.vertices[self.component_vertex])
        piece = np.full(len(self.mesh.faces), -1, dtype=np.int64)
        piece[self.face_number] = self.component
        holder = piece[face]
        others = (holder >= 0) & (holder != asked)
        keys, crossings = np.unique(asked[others] * self.component_count + holder[others], return_counts=True)
        holding = keys[crossings % 2 == 1] // self.component_count
        return np.bincount(holding, minlength=self.component_count)

    @cached_property
    def inside_out(self) -> Ints | None:
        """Pieces that look the wrong way, (K,); None unless the mesh is closed, manifold and consistent.

        A piece held by an even number of others bounds the body from outside and has positive volume; one held by an
        odd number is a cavity, whose faces look into the hollow, and has negative volume.
        """
        if not (self.closed and self.manifold and self.consistent):
            return None
        expected = 1 - 2 * (self.component_depths % 2)
        return np.flatnonzero(np.sign(self.component_volumes) != expected)
