"""`tetrahedralize`: files that their readers load, and refusals with the faces at fault."""

import meshio
import numpy as np
import pytest
from pydantic import ValidationError

from core.errors import InputError
from core.package.build import build_package
from core.schema.tetrahedralize import TetrahedralizeInputs
from tests.core.package.nested import figures, report, tissues
from tests.core.processes.test_surface_processes import executed, href, of_one, of_package, stored
from tests.core.tetrahedra.refused_by_tetgen import tetgen_refuses
from tests.gmsh_reader import sizes_in_gmsh
from tests.solids import cube, sphere, without_faces


@pytest.fixture(scope="module", params=["tetgen", "gmsh"])
def done(tmp_path_factory, request):
    folder = tmp_path_factory.mktemp("tetrahedra")
    build_package(folder / "package.zip", tissues(), report(), figures())
    return of_package(
        "tetrahedralize", folder, folder / "package.zip", mesher=request.param, max_volume_mm3={"average_body": 5.0}
    )


def test_the_msh_has_surfaces_and_regions_by_number(done):
    mesh = meshio.read(done["files"]["msh"])
    tags = mesh.cell_data_dict["gmsh:physical"]
    assert set(tags["triangle"]) == {1005, 1012, 1010}
    assert set(tags["tetra"]) == {5, 12, 10}
    given = np.vstack([tissue.mesh.vertices for tissue in tissues()])
    np.testing.assert_array_equal(np.unique(mesh.points[: len(given)], axis=0), np.unique(given, axis=0))


def test_gmsh_reads_it(done):
    sizes = sizes_in_gmsh(done["files"]["msh"], dimension=3)
    assert sizes == {region.region_tag: region.tetrahedra for region in done["report"].regions.values()}


def test_the_vtu_has_conductivities(done):
    mesh = meshio.read(done["files"]["vtu"])
    fat = mesh.cell_data["region_tag"][0] == 12
    assert set(mesh.cell_data["conductivity_s_per_m"][0][fat]) == {0.078}


def test_the_report_has_a_row_per_tissue(done):
    regions = done["report"].regions
    assert list(regions) == ["skin", "fat", "average_body"]
    assert sum(region.volume_mm3 for region in regions.values()) == pytest.approx(done["report"].meshes["skin"].volume_mm3)
    assert all(
        0 < region.quality_minimum <= region.quality_percentile_1 <= region.quality_median <= 1 for region in regions.values()
    )
    assert all(0 < region.radius_ratio_minimum <= region.radius_ratio_median <= 1 for region in regions.values())
    assert all(0 < region.smallest_dihedral_deg <= region.dihedral_percentile_1_deg < 70.6 for region in regions.values())
    page = done["files"]["report_html"].read_text(encoding="utf-8")
    assert "Tetrahedra" in page
    assert done["verdict"] == "simulation_ready"
    mesher = done["report"].parameters["mesher"]
    assert mesher in done["report"].software
    assert mesher in done["report"].methods.lower()


def test_the_report_says_that_gmsh_stood_in_for_tetgen(tmp_path):
    surfaces, _nesting = tetgen_refuses()
    entries = stored(tmp_path, surfaces)
    inputs = {"meshes": {name: {"href": href(number)} for number, name in enumerate(surfaces)}}
    report = executed("tetrahedralize", tmp_path, inputs, entries)["report"]
    assert report.verdict == "simulation_ready"
    assert [finding.code for finding in report.findings if finding.code.startswith("tetrahedra.")] == ["tetrahedra.by_gmsh"]
    assert "gmsh" in report.software
    assert "tetgen" not in report.software
    assert "by gmsh [3]" in report.methods
    assert "Gmsh" in report.references[-1]
    assert report.parameters["mesher"] == "auto"


def test_one_surface_alone(tmp_path):
    alone = of_one("tetrahedralize", tmp_path, cube(10.0), radius_edge=None)
    assert alone["report"].regions["mesh"].volume_mm3 == pytest.approx(1000.0)


@pytest.mark.parametrize(
    ("meshes", "finding"),
    [
        ({"a": without_faces(cube(10.0), [0])}, "mesh.not_closed"),
        ({"a": sphere(5.0, 2), "b": sphere(5.0, 2, at=(4.0, 0.3, 0.2))}, "pair.intersecting"),
        ({"a": cube(10.0), "b": cube(10.0, at=(10.0, 0.0, 0.0))}, "pair.intersecting"),
    ],
)
def test_unfit_surfaces_are_refused_with_the_faces(tmp_path, meshes, finding):
    entries = stored(tmp_path, meshes)
    inputs = {"meshes": {name: {"href": href(number)} for number, name in enumerate(meshes)}}
    with pytest.raises(InputError) as error:
        executed("tetrahedralize", tmp_path, inputs, entries)
    assert error.value.code == "tetrahedra.surfaces_unfit"
    assert finding in {found.code for found in error.value.findings}
    assert all(found.places for found in error.value.findings)
    assert "TetGen" not in error.value.report.methods
    assert error.value.outputs


def test_the_ratio_of_radii_is_tetgens_alone():
    with pytest.raises(ValidationError, match="radius_edge is TetGen's"):
        TetrahedralizeInputs.model_validate({"mesh": {"href": href(0)}, "mesher": "gmsh", "radius_edge": 1.2})


def test_a_tissue_that_is_not_there_is_named(tmp_path):
    with pytest.raises(InputError, match="bone") as error:
        of_one("tetrahedralize", tmp_path, cube(10.0), max_volume_mm3={"bone": 1.0})
    assert error.value.code == "tetrahedra.unknown_tissue"
