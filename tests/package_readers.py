"""Every export of a package, loaded by the program or library it is made for; all must tell the same as the manifest."""

from __future__ import annotations

import json
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import meshio
import mne
import numpy as np
import openmeeg
import scipy.io
import tetgen
import yaml

from tests.gmsh_reader import sizes_in_gmsh

SURFACE = 1000  # a surface's number in gmsh files is this and its tissue's


def read_every_export(folder: Path) -> dict[str, Any]:
    """The manifest of an unpacked package; raises what a reader raises."""
    manifest: dict[str, Any] = json.loads((folder / "manifest.json").read_text())
    _read_surfaces(folder, manifest)
    _read_indices(folder, manifest)
    _read_openmeeg(folder, manifest)
    _read_mne(folder, manifest)
    faces = {tissue["region_tag"]: tissue["faces"] for tissue in manifest["tissues"]}
    assert sizes_in_gmsh(folder / "gmsh/surfaces.msh", dimension=2) == {SURFACE + tag: count for tag, count in faces.items()}
    nastran = meshio.read(folder / "nastran/surfaces.nas").cell_data_dict["nastran:ref"]["triangle"]
    assert {int(tag): int((nastran == tag).sum()) for tag in np.unique(nastran)} == faces
    assert fill_smesh(folder / "tetgen/surfaces.smesh") == set(faces)
    if "gmsh/volume.msh" in manifest["files"]:
        _read_volume(folder / "gmsh/volume.msh", faces)
    return manifest


def fill_smesh(path: Path) -> set[int]:
    """TetGen's regions after it filled the facets of a file, read by the rules of the format: Python's TetGen takes arrays alone.

    A point region is `number x y z attribute`; the facets' `corners a b c mark` count from the first vertex' number."""
    rows = [line.split() for line in path.read_text().splitlines() if line and not line.startswith("#")]
    count = int(rows[0][0])
    vertices = np.array([row[1:4] for row in rows[1 : count + 1]], dtype=float)
    first = int(rows[1][0])
    facets = int(rows[count + 1][0])
    faces = np.array([row[1:4] for row in rows[count + 2 : count + 2 + facets]], dtype=np.int64) - first
    holes, points = rows[count + 2 + facets], rows[count + 4 + facets :]
    assert holes == ["0"]
    filler = tetgen.TetGen(vertices, faces.astype(np.int32))
    for point in points:
        filler.add_region(int(float(point[4])), tuple(float(value) for value in point[1:4]), 0.0)
    _nodes, _tetrahedra, region, *_ = filler.tetrahedralize(switches="pYAQT1e-12")
    return {int(tag) for tag in np.unique(np.rint(region))}


def _read_surfaces(folder: Path, manifest: dict[str, Any]) -> None:
    for tissue in manifest["tissues"]:
        stl = meshio.read(folder / tissue["file"])
        mat = scipy.io.loadmat(folder / tissue["mat_file"])
        assert {mat[name].dtype for name in ("P", "t", "normals")} == {np.dtype(np.float64)}
        corners = stl.points[stl.cells_dict["triangle"]]
        np.testing.assert_array_equal(mat["P"][mat["t"].astype(int) - 1], corners)
        assert len(corners) == tissue["faces"]


def _read_indices(folder: Path, manifest: dict[str, Any]) -> None:
    """Both of BEM-FMM, by the rules of its readers: rows with three colons, and a mapping."""
    rows = [line[1:].split(":") for line in (folder / "bem-fmm/tissue_index.txt").read_text().splitlines() if line[:1] == ">"]
    around = {name.strip(): enclosing.strip() for name, _file, _value, enclosing in rows}
    assert around == {tissue["name"]: tissue["enclosing_tissue"] for tissue in manifest["tissues"]}
    assert all((folder / "bem-fmm" / file.strip()).is_file() for _name, file, _value, _enclosing in rows)
    shells = yaml.safe_load((folder / "bem-fmm/tissue_index.yaml").read_text())["shells"]
    assert {name: enclosing for name, (_value, enclosing, _file) in shells.items()} == around
    assert all((folder / "bem-fmm" / file).is_file() for _value, _enclosing, file in shells.values())


def _read_openmeeg(folder: Path, manifest: dict[str, Any]) -> None:
    """`read_geometry` turns meshes that look the wrong way and refuses domains that do not fit them."""
    geometry = openmeeg.read_geometry(str(folder / "openmeeg/model.geom"), str(folder / "openmeeg/model.cond"))
    for tissue in manifest["tissues"]:
        mesh = geometry.mesh(tissue["name"])
        assert len(mesh.triangles()) == tissue["faces"]
        assert mesh.has_correct_orientation()
    assert len(geometry.vertices()) == sum(tissue["vertices"] for tissue in manifest["tissues"])


def _read_mne(folder: Path, manifest: dict[str, Any]) -> None:
    """The outermost surface from its MAT file, as README.txt tells: MNE itself decides whether it is complete."""
    skin = manifest["tissues"][0]
    surface = scipy.io.loadmat(folder / skin["mat_file"])
    with TemporaryDirectory() as name:
        target = Path(name) / "body" / "bem" / "inner_skull.surf"  # where MNE looks for a single layer
        target.parent.mkdir(parents=True)
        mne.write_surface(target, surface["P"], surface["t"].astype(int) - 1, verbose="ERROR")
        (layer,) = mne.make_bem_model("body", ico=None, conductivity=(0.3,), subjects_dir=name, verbose="ERROR")
    assert len(layer["tris"]) == skin["faces"]
    np.testing.assert_allclose(1000 * layer["rr"], surface["P"], atol=1e-3)  # its file is float32


def _read_volume(path: Path, faces: dict[int, int]) -> None:
    """gmsh finds tetrahedra in each tissue and each surface whole; meshio as many."""
    tetrahedra = sizes_in_gmsh(path, dimension=3)
    assert set(tetrahedra) == set(faces)
    assert sizes_in_gmsh(path, dimension=2) == {SURFACE + tag: count for tag, count in faces.items()}
    assert len(meshio.read(path).cells_dict["tetra"]) == sum(tetrahedra.values())
