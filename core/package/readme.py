"""README.txt of a package: what is in it and how to load it, and nothing that is not true of these very files."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import dedent

from core.package.tissue import Tissue
from core.schema.report import Report

MNE_LAYERS = (1, 3)


def readme_text(tissues: Sequence[Tissue], report: Report, *, with_volume: bool = False) -> str:
    """Plain text, narrow enough for any editor. with_volume: the package has tetrahedra, too."""
    outer, inner = tissues[0].name, tissues[-1].name
    return "\n".join(
        [
            _head(tissues, report, with_volume),
            _section("MATLAB", _MATLAB, outer),
            _section("BEM-FMM", _BEM_FMM, outer),
            _section("Python", _PYTHON, outer),
            _section("SimNIBS and gmsh", _GMSH_VOLUME if with_volume else _GMSH, outer),
            _section("OpenMEEG", _OPENMEEG, outer),
            _section("MNE-Python", dedent(_MNE).rstrip() + _mne_layers(len(tissues), outer, inner), outer),
            _section("HFSS and other CAD programs", _HFSS, outer),
        ]
    )


def _head(tissues: Sequence[Tissue], report: Report, with_volume: bool) -> str:
    rows = [
        f"  {each.name:<24} {len(each.mesh.faces):>9} {_depth(each):>9} {each.conductivity_s_per_m:>8.4f}  {each.enclosing}"
        for each in tissues
    ]
    lines = [
        "Nested surfaces of a human model, in millimetres",
        "================================================",
        "",
        f"Verdict: {report.verdict}. What was proven: report/report.html (for a browser) and report/report.json.",
        "",
        f"  {'tissue':<24} {'faces':>9} {'depth mm':>9} {'S/m':>8}  enclosed by",
        *rows,
        "",
        "Every surface is the outer border of its tissue; the tissue fills the space down to the next surface",
        "inside. Faces run counter-clockwise seen from outside. Conductivities that were not given with the job",
        "are quasi-static defaults, up to some 10 kHz; their sources are in manifest.json. Tissues conduct better",
        "at higher frequencies: give your own.",
        "",
        "  stl/NAME.stl       binary STL, float32",
        "  mat/NAME.mat       P (vertices), t (faces, from 1), normals (outward, one per face), all double;",
        "                     the same vertices as the STL, bit for bit",
        "  bem-fmm/           tissue_index.txt with its MAT files for MATLAB, tissue_index.yaml for Python",
        "  openmeeg/          model.geom, model.cond and NAME.tri",
        "  gmsh/, nastran/, tetgen/   all surfaces in one file, numbered by region_tag of manifest.json",
        "  glb/surfaces.glb   all surfaces in their colours for viewers and slides, in metres",
        *(["  gmsh/volume.msh    tetrahedra of all tissues, and their surfaces"] if with_volume else []),
        "  manifest.json      tissues, parameters, versions, and the SHA-256 of every file",
        "  report/  what was proven, with pictures",
    ]
    return "\n".join(lines) + "\n"


def _depth(tissue: Tissue) -> str:
    return "-" if tissue.depth_mm is None else f"{tissue.depth_mm:g}{' out' if tissue.side == 'outside' else ''}"


def _section(title: str, text: str, outer: str) -> str:
    return f"{title}\n{'-' * len(title)}\n{dedent(text).strip()}\n".replace("OUTER", outer)


def _mne_layers(count: int, outer: str, inner: str) -> str:
    here = f"this package has {count}, from {outer} to {inner}." if count in MNE_LAYERS else f"this package has {count}: choose."
    return f"\nIts BEM takes one or three nested surfaces and warns above 10,000 vertices;\n{here}\n"


_MATLAB = """
    m = load('mat/OUTER.mat');      % P in mm, t counted from 1, normals
    patch('Vertices', m.P, 'Faces', m.t, 'FaceColor', [0.9 0.75 0.6], 'EdgeColor', 'none');
    axis equal; camlight; lighting gouraud
"""
_BEM_FMM = """
    MATLAB: copy the files of bem-fmm/ into the folder of your model and run its scripts there; the index
    names its MAT files without a path. P is in mm: use the scripts that scale it by 1e-3.
    Python: give bem-fmm/tissue_index.yaml as the tissue index; it refers to ../stl/.
"""
_PYTHON = """
    import scipy.io
    surface = scipy.io.loadmat("mat/OUTER.mat")
    vertices_mm, faces = surface["P"], surface["t"].astype(int) - 1
"""
_GMSH = """
    gmsh gmsh/surfaces.msh
    The mark of a triangle is 1000 + the number of its tissue. SimNIBS computes on tetrahedra, which these
    files do not have: `tetgen -pA tetgen/surfaces.smesh` fills them and gives each its tissue's number.
"""
_GMSH_VOLUME = """
    gmsh gmsh/volume.msh
    Tetrahedra with the number of their tissue, and its surface with 1000 + that number, as SimNIBS has it:
    it is the head model. Numbers above 100 are not its own: give it their conductivities.
    gmsh/surfaces.msh has the surfaces alone.
"""
_OPENMEEG = """
    import openmeeg
    geometry = openmeeg.read_geometry("openmeeg/model.geom", "openmeeg/model.cond")
    Lengths are mm: dipoles, sensors and moments must be in mm, too. A dense method: decimate first.
"""
_MNE = """
    MNE-Python does not read STL. Take vertices and faces as under Python;
    mne.write_surface(path, vertices_mm, faces) saves them as a FreeSurfer surface.
"""
_HFSS = """
    Import the files of stl/ one by one with the model unit set to mm. STL has no unit of its own.
"""
