"""A caller's own conductivities reach every file of the package that has conductivities, and the volume mesh."""

import json
import zipfile
from pathlib import Path

import meshio
import pytest

from core.errors import InputError
from core.package.build import build_package
from tests.core.package.nested import figures, report, tissues
from tests.core.processes.test_surface_processes import executed, href, of_package, stored
from tests.solids import sphere

OWN = {"fat": 0.05}


def require_told(package: Path) -> None:
    with zipfile.ZipFile(package) as archive:
        entries = {entry["name"]: entry for entry in json.loads(archive.read("manifest.json"))["tissues"]}
        assert entries["fat"]["conductivity_s_per_m"] == 0.05
        assert (entries["fat"]["conductivity_source"], entries["fat"]["conductivity_frequency"]) == (
            "given with the tissue",
            None,
        )
        assert entries["skin"]["conductivity_s_per_m"] == 0.465
        assert ">fat : fat.mat : 0.0500 : skin" in archive.read("bem-fmm/tissue_index.txt").decode()
        assert '"fat": [0.0500, "skin"' in archive.read("bem-fmm/tissue_index.yaml").decode()
        assert "fat 0.05\n" in archive.read("openmeeg/model.cond").decode()
        assert "0.0500" in archive.read("README.txt").decode()


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("own")
    build_package(folder / "package.zip", tissues(), report(), figures())
    return folder / "package.zip"


def test_a_package_that_is_worked_on_gets_them(package, tmp_path):
    require_told(of_package("decimate", tmp_path, package, target_ratio=0.9, conductivities_s_per_m=OWN)["files"]["package"])


def test_layers_get_them(tmp_path):
    entries = stored(tmp_path, {"skin": sphere(30.0, 3)})
    done = executed("shells", tmp_path, {"skin": {"href": href(0)}, "conductivities_s_per_m": OWN}, entries)
    require_told(done["files"]["package"])


def test_the_volume_mesh_gets_them(package, tmp_path):
    done = of_package("tetrahedralize", tmp_path, package, conductivities_s_per_m=OWN)
    mesh = meshio.read(done["files"]["vtu"])
    values = mesh.cell_data["conductivity_s_per_m"][0]
    assert set(values[mesh.cell_data["region_tag"][0] == 12]) == {0.05}


def test_names_that_a_package_does_not_have_are_refused(package, tmp_path):
    with pytest.raises(InputError, match="bone") as error:
        of_package("decimate", tmp_path, package, target_ratio=0.9, conductivities_s_per_m={"bone": 0.01})
    assert error.value.code == "conductivity.unknown_tissue"
