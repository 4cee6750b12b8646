import pytest

from core.errors import InputError
from core.geometry.normals import vertex_normals
from core.mesh import Mesh
from core.schema.finding import has_errors
from core.validation.requirements import require_fit_skin
from subjects.body import body
from tests.solids import cube, flipped, sphere, tetrahedron, together, torus, with_faces, without_faces


@pytest.mark.parametrize("mesh", [cube(), sphere(), torus(), body()], ids=["cube", "sphere", "torus", "body"])
def test_fit(mesh):
    require_fit_skin(mesh, "skin")


def self_touching() -> Mesh:
    """A sphere dented so far that its topmost vertex comes to lie on its lowest."""
    mesh = sphere(1.0, 3)
    vertices = mesh.vertices.copy()
    vertices[vertices[:, 2].argmax()] = vertices[vertices[:, 2].argmin()]
    return mesh.with_vertices(vertices)


BAD = {
    "skin.degenerate": with_faces(cube(), [[0, 1, 1]]),
    "skin.not_manifold": with_faces(cube(), [[0, 3, 7], [0, 7, 4]]),
    "skin.not_closed": without_faces(cube(), [0]),
    "skin.not_oriented": flipped(cube(), [0]),
    "skin.inside_out": flipped(cube()),
    "skin.several_bodies": together(cube(), cube(at=(5, 0, 0))),
    "skin.self_touching": self_touching(),
    "skin.self_intersecting": body().with_vertices(body().vertices - 3 * vertex_normals(body().vertices, body().faces)),
}


@pytest.mark.parametrize("code", BAD)
def test_unfit(code):
    with pytest.raises(InputError) as failure:
        require_fit_skin(BAD[code], "grandma")
    assert failure.value.code == code
    assert failure.value.findings
    assert has_errors(failure.value.findings)
    assert all(finding.places for finding in failure.value.findings)
    assert failure.value.facts["count"] == failure.value.findings[0].count
    assert "grandma" in failure.value.message
    assert "heal" in failure.value.message


def test_a_cavity_is_a_second_body():
    with pytest.raises(InputError, match="1 of them are cavities") as failure:
        require_fit_skin(together(sphere(3.0), flipped(sphere(1.0))), "skin")
    assert failure.value.code == "skin.several_bodies"


def test_all_failures_are_told_at_once():
    with pytest.raises(InputError) as failure:
        require_fit_skin(without_faces(together(cube(), tetrahedron(at=(0.5, 0.5, 0.5))), [0]), "skin")
    assert failure.value.code == "skin.not_closed"
    codes = [finding.code for finding in failure.value.findings]
    assert codes == ["mesh.not_closed", "mesh.several_components", "mesh.self_intersecting"]
