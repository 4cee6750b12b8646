"""Decimation of the body to a quarter of its faces: ours against fast-simplification and MeshLab's quadrics, in one process."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import fast_simplification
import numpy as np
import pymeshlab

from benchmarks.table import print_table, thousands
from core.decimation.collapse import REASONS
from core.decimation.curvature import mean_neighbour_angles_deg
from core.decimation.decimate import OWN_CLEARANCE_MM, decimate
from core.decimation.literal import collapse_literally
from core.decimation.nearness import ANYWHERE
from core.decimation.plan import make_plans
from core.decimation.room import NO_OBSTACLES
from core.decimation.thinned import Means, thinned
from core.geometry.adjacency import edges
from core.geometry.deviation import measure_deviation
from core.geometry.exact_intersection import find_intersecting_faces
from core.geometry.normals import face_areas
from core.geometry.quality import quality
from core.mesh import Mesh
from core.run import SILENT
from core.schema.decimate import DecimateInputs
from subjects.body import body

UPLOAD = {"href": "/v1/meshes/00000000-0000-4000-8000-000000000000"}
RATIO = 0.25
TENTH = 0.1
REPEATS = 3
THESIS_S = 6.2  # per collapse at 5,120 faces: the script of Appendix A in Octave
LITERAL_COLLAPSES = 1000
HEAD = (
    "method", "faces", "exact crossing pairs", "genus 0", "mean q", "min q", "rms mm", "rms mm, most bent tenth",
    "rms mm, most curved tenth", "max mm, both ways", "CPU s", "times fast-simplification",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Row:
    """One method on one body."""

    mesh: Mesh
    seconds: float


def compare_decimation(subdivisions: int, *, peers: bool) -> bool:
    """Print the table; False if the surface is not sound, or peers are ahead where they must not be."""
    mesh = body(subdivisions)
    goal = int(RATIO * len(mesh.faces))
    makers: dict[str, Callable[[], Mesh]] = {
        "integument, curvature": lambda: _engine(mesh, "curvature"),
        "integument, quadric": lambda: _engine(mesh, "quadric"),
        "integument, curvature, with checks, proof and measures": lambda: _everything(mesh),
    }
    if peers:
        makers |= {
            "fast-simplification": lambda: _fast_simplification(mesh, goal),
            "pymeshlab quadric edge collapse": lambda: _pymeshlab(mesh, goal),
        }
    _engine(body(0), "curvature")  # compile before the clock starts
    _engine(body(0), "quadric")
    rows = {name: _timed(make) for name, make in makers.items()}
    bent = mean_neighbour_angles_deg(mesh)
    tenths = (_top(mesh, bent), _top(mesh, bent / _distance_to_neighbours(mesh)))
    fastest = rows["fast-simplification"].seconds if peers else None
    print_table(
        f"{thousands(len(mesh.faces))} to {thousands(goal)} faces",
        HEAD,
        [_words(name, row, mesh, tenths, fastest) for name, row in rows.items()],
    )
    ours = rows["integument, curvature"]
    sound = len(find_intersecting_faces(ours.mesh.vertices, ours.mesh.faces)) == 0
    if not peers:
        return sound
    theirs = rows["pymeshlab quadric edge collapse"]
    ahead = _mean_q(ours.mesh) > _mean_q(theirs.mesh) and ours.seconds < theirs.seconds
    return sound and ahead and all(_rms(mesh, ours.mesh, tenth) <= _rms(mesh, theirs.mesh, tenth) for tenth in tenths)


def compare_literal() -> None:
    """The thesis' script, compiled and updated locally, on a sphere of 5,120 faces."""
    work = pymeshlab.MeshSet()
    work.create_sphere(radius=50.0, subdiv=4)
    current = work.current_mesh()
    mesh = Mesh.of(current.vertex_matrix(), current.face_matrix())
    collapse_literally(mesh, len(mesh.faces) - 10, 0.8)
    start = time.process_time()
    made = collapse_literally(mesh, len(mesh.faces) - 2 * LITERAL_COLLAPSES, 0.8)
    each = (time.process_time() - start) / made.attempts["done"]
    print_table(
        f"Appendix A step for step, {thousands(len(mesh.faces))} faces",
        ("script in Octave, s per collapse", "literal, s per collapse", "ratio"),
        [(f"{THESIS_S}", f"{each:.2g}", thousands(round(THESIS_S / each)))],
    )


def _engine(mesh: Mesh, method: str) -> Mesh:
    """Geometry alone, guards included: no check of the input, no proof, no measures."""
    inputs = DecimateInputs.model_validate({"mesh": UPLOAD, "method": method, "target_ratio": RATIO})
    plan = make_plans({"body": mesh}, inputs)["body"]
    means = Means(method == "curvature", inputs.smooth_weight, OWN_CLEARANCE_MM, NO_OBSTACLES)
    made = thinned(mesh, plan, np.zeros(len(mesh.vertices), dtype=np.bool_), ANYWHERE, means, SILENT)
    assert set(made.attempts) == set(REASONS)
    return made.mesh


def _everything(mesh: Mesh) -> Mesh:
    return decimate({"body": mesh}, DecimateInputs.model_validate({"mesh": UPLOAD, "target_ratio": RATIO}))["body"].mesh


def _fast_simplification(mesh: Mesh, goal: int) -> Mesh:
    points, faces = fast_simplification.simplify(mesh.vertices.astype(np.float32), mesh.faces.copy(), target_count=goal)
    return Mesh.of(points, faces)


def _pymeshlab(mesh: Mesh, goal: int) -> Mesh:
    work = pymeshlab.MeshSet()
    work.add_mesh(pymeshlab.Mesh(mesh.vertices, mesh.faces))
    work.meshing_decimation_quadric_edge_collapse(targetfacenum=goal)
    current = work.current_mesh()
    return Mesh.of(current.vertex_matrix(), current.face_matrix()).rounded_to_float32()


def _timed(make: Callable[[], Mesh]) -> Row:
    """CPU seconds of the fastest of some runs: other work on the machine only ever adds."""
    seconds, mesh = [], None
    for _ in range(REPEATS):
        start = time.process_time()
        mesh = make()
        seconds.append(time.process_time() - start)
    assert mesh is not None
    return Row(mesh, min(seconds))


def _words(name: str, row: Row, original: Mesh, tenths: tuple[np.ndarray, ...], fastest: float | None) -> tuple[str, ...]:
    mesh = row.mesh
    shape = quality(mesh.vertices, mesh.faces)
    deviation = measure_deviation(original, mesh)
    table = edges(mesh.faces)
    closed = bool((table.face_count == 2).all())
    ball = len(np.unique(mesh.faces)) - len(table.ends) + len(mesh.faces) == 2
    return (
        name,
        thousands(len(mesh.faces)),
        thousands(len(find_intersecting_faces(mesh.vertices, mesh.faces))),
        "yes" if closed and ball else "no",
        f"{shape.mean():.3f}",
        f"{shape.min():.2g}",
        f"{_rms(original, mesh, np.arange(len(original.faces))):.4f}",
        *(f"{_rms(original, mesh, tenth):.4f}" for tenth in tenths),
        f"{deviation.maximum_mm:.3f}",
        f"{row.seconds:.2f}",
        "-" if fastest is None else f"{row.seconds / fastest:.1f}",
    )


def _mean_q(mesh: Mesh) -> float:
    return float(quality(mesh.vertices, mesh.faces).mean())


def _rms(original: Mesh, mesh: Mesh, faces: np.ndarray) -> float:
    """Root mean square distance of some faces of the original from the result, by area."""
    way = measure_deviation(original, mesh).forth
    return float(np.sqrt((way.mean_square() * way.areas)[faces].sum() / way.areas[faces].sum()))


def _top(mesh: Mesh, values: np.ndarray) -> np.ndarray:
    """The faces of highest value that make up a tenth of the area."""
    order = np.argsort(-values, kind="stable")
    areas = face_areas(mesh.vertices, mesh.faces)[order]
    return order[np.cumsum(areas) <= TENTH * areas.sum()]


def _distance_to_neighbours(mesh: Mesh) -> np.ndarray:
    """Mean distance between the middles of neighbouring faces, (F,) mm: an angle over it is a curvature per length."""
    middle = mesh.triangles().mean(axis=1)
    _edge, face, _side = edges(mesh.faces).two_faces()
    apart = np.linalg.norm(middle[face[:, 0]] - middle[face[:, 1]], axis=1)
    return np.bincount(face.ravel(), weights=np.repeat(apart, 2), minlength=len(mesh.faces)) / 3.0
