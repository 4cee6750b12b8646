"""Every equation on a star whose new centre can be computed by hand."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.connectivity import Connectivity
from core.geometry.face_tree import FaceTree
from core.mesh import Mesh
from core.schema.smooth import SmoothInputs
from core.smoothing.proposal import Original, propose
from core.smoothing.star_centres import circumcentre_centres
from tests.solids import octahedron, sphere

UPLOAD = {"href": "/v1/meshes/00000000-0000-4000-8000-000000000000"}

# a square of side 4 around a vertex at (1, 1): areas 2, 6, 6, 2; in the plane z = 5, far from the origin
CORNERS = np.array([[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]], dtype=float)
AT = np.array([1000.0, -2000.0, 5.0])


def star(centre=(1.0, 1.0, 0.0)) -> Mesh:
    return Mesh.of(np.vstack((CORNERS, [centre])) + AT, [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])


def moved(mesh: Mesh, chosen, original: Mesh | None = None, **wanted) -> np.ndarray:
    start = original or mesh
    inputs = SmoothInputs(mesh=UPLOAD, **wanted)
    before = Original(start.vertices, FaceTree.of(start.vertices, start.faces))
    net = Connectivity.of(mesh.faces, len(mesh.vertices))
    return propose(mesh.vertices, before, net, np.asarray(chosen), inputs)


def centre_after(**wanted) -> np.ndarray:
    return moved(star(), [4], **wanted)[4] - AT


def test_standard_goes_to_the_mean_of_the_neighbours():
    assert centre_after(method="standard") == pytest.approx([2, 2, 0])


def test_lumped_goes_two_thirds_of_the_way():
    assert centre_after(method="lumped") == pytest.approx([1 / 3 + 2 / 3 * 2, 1 / 3 + 2 / 3 * 2, 0])


def test_cvt_goes_to_the_centroids_weighted_by_area():
    # below: centroid (5/3, 1/3), area 2; right (3, 5/3), 6; above (5/3, 3), 6; left (1/3, 5/3), 2; together 16
    x = (2 * 5 / 3 + 6 * 3 + 6 * 5 / 3 + 2 * 1 / 3) / 16
    assert centre_after(method="cvt") == pytest.approx([x, x, 0])


def test_cvt_with_equal_weights_goes_to_the_mean_of_the_centroids():
    x = (5 / 3 + 3 + 5 / 3 + 1 / 3) / 4
    assert centre_after(method="cvt", equal_weights=True) == pytest.approx([x, x, 0])


def test_wcc_goes_to_the_circumcentres_weighted_by_area():
    # below: (0,0), (4,0), (1,1): x = 2, |c|² = |c - (1,1)|² gives y = -1; right, by symmetry of its corners (4,0), (4,4), (1,1):
    # y = 2, (4-x)² + 4 = (x-1)² + 1 gives x = 3; above and left are their mirror images
    x = (2 * 2 + 6 * 3 + 6 * 2 + 2 * -1) / 16
    assert centre_after(method="wcc") == pytest.approx([x, x, 0])
    # the weighted circumcentres of a polygon do not depend on where its inner vertex is: a square's are its middle
    assert x == 2


def test_wcc_with_equal_weights():
    x = (2 + 3 + 2 - 1) / 4
    assert centre_after(method="wcc", equal_weights=True) == pytest.approx([x, x, 0])


def test_circumcentres_of_needles_stay_finite():
    mesh = star((2.0, 1e-9, 0.0))
    net = Connectivity.of(mesh.faces, 5)
    centre = circumcentre_centres(mesh.vertices, mesh.faces, net.faces_around, np.array([4]), equal=False)[0] - AT
    assert centre == pytest.approx([2, 2, 0], abs=1e-5)  # independent of the vertex, even here


@pytest.mark.parametrize("method", ["standard", "lumped", "cvt", "wcc"])
def test_weight_is_a_share_of_the_way(method):
    whole, quarter = centre_after(method=method), centre_after(method=method, weight=0.25)
    assert quarter - [1, 1, 0] == pytest.approx((whole - [1, 1, 0]) / 4)


def test_hc_of_one_vertex_alone():
    # p* = (2, 2), b = p* - p = (1, 1), the fixed neighbours have none: p* - 0.6 b
    assert centre_after(method="hc", hc_alpha=0.0, hc_beta=0.6) == pytest.approx([1.4, 1.4, 0])


def test_hc_pulls_towards_the_original_place():
    # p = (1, 1), original (0, 2): b = p* - (0.5 o + 0.5 p) = (1.5, 0.5); p* - 0.8 b
    original = star((0.0, 2.0, 0.0))
    place = moved(star(), [4], original, method="hc", hc_alpha=0.5, hc_beta=0.8)[4] - AT
    assert place == pytest.approx([2 - 0.8 * 1.5, 2 - 0.8 * 0.5, 0])


def test_hc_shares_the_push_with_the_neighbours():
    # octahedron, all move: p* = 0, b = -p for each, the four neighbours' b add up to 0: p* - β b = β p
    mesh = octahedron(3.0)
    assert moved(mesh, range(6), method="hc", hc_alpha=0.0, hc_beta=0.75) == pytest.approx(0.75 * mesh.vertices)


def test_taubin_steps_in_and_out():
    # in by half the way to (1.5, 1.5), then out by 0.6 of what is left of it
    place = centre_after(method="taubin", taubin_lambda=0.5, taubin_mu=-0.6)
    assert place == pytest.approx([1.5 - 0.6 * 0.5, 1.5 - 0.6 * 0.5, 0])


def test_along_the_surface_drops_what_leads_off_it():
    raised = star((1.0, 1.0, 0.5))
    everywhere = moved(raised, [4], method="standard")[4]
    along = moved(raised, [4], method="standard", along_surface=True)[4]
    assert everywhere - AT == pytest.approx([2, 2, 0])
    # and is brought back onto the original surface: its distance to the nearest face is none
    assert along[2] - AT[2] > 0.1
    mesh = sphere(10.0, 3)
    slid = moved(mesh, range(len(mesh.vertices)), method="cvt", along_surface=True)
    sunk = moved(mesh, range(len(mesh.vertices)), method="cvt")
    radius = np.linalg.norm(mesh.triangles().mean(axis=1), axis=1).min()
    assert np.linalg.norm(slid, axis=1).min() >= radius > np.linalg.norm(sunk, axis=1).min()


def test_no_vertex_goes_farther_than_allowed():
    place = centre_after(method="standard", max_shift_mm=0.5)
    assert place == pytest.approx([1 + 0.5 / np.sqrt(2), 1 + 0.5 / np.sqrt(2), 0], abs=2e-4)
    assert np.linalg.norm(place - [1, 1, 0]) < 0.5


def test_only_the_chosen_move_and_all_at_once():
    mesh = sphere(10.0, 1)
    chosen = np.arange(0, len(mesh.vertices), 2)
    together = moved(mesh, chosen, method="standard")
    for vertex in chosen:
        assert together[vertex] == pytest.approx(moved(mesh, [vertex], method="standard")[vertex])
    assert (np.delete(together, chosen, axis=0) == np.delete(mesh.vertices, chosen, axis=0)).all()
