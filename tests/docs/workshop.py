"""A server, and for each page a folder with the files its blocks speak of; a page is one shell script, run from top to bottom."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import scipy.io
from integument import Client
from numpy.typing import NDArray

from core.ears.canal import make_canal
from core.io.registry import write_mesh
from core.mesh import Mesh
from subjects.figure_eight import above_head, figure_eight, primary_field, write_ccd
from subjects.generated.pieces import moved, opened
from subjects.generated.revolved import ball
from subjects.touching import arms_lowered, grown_together
from tests.core.io.nifti_bytes import nifti, packed
from tests.docs.blocks import Block

MATLAB = Path(__file__).parent / "matlab"
ADDRESSES = ("http://127.0.0.1:8000", "http://lab-server:8000")  # what the pages call the server
PAGE_S = 3000  # a page of whole bodies on a busy machine; two minutes on a quiet one
TISSUES = {"head": (40.0, 0.0), "skull": (30.0, 0.0), "grey": (25.0, 5.2), "white": (15.0, 5.2)}
"""Name -> radius and shift in mm of a ball; grey crosses the skull."""
CANALS = {"left": (68.1, 706.7, 55.0), "right": (-68.1, 706.7, 55.0)}


@dataclass(frozen=True, slots=True)
class Workshop:
    """One server with a skin and its shells; files: name -> content, laid into the folder of every page."""

    url: str
    files: dict[str, bytes]
    mesh: str
    job: str
    volume: str

    @classmethod
    def of(cls, url: str, skin: Mesh, folder: Path, *, is_body: bool = False) -> Workshop:
        """Upload the skin, make its shells, and write what pages take for granted."""
        write_mesh(skin, folder / "skin.stl", "stl", "skin")
        write_mesh(opened(skin, 3), folder / "broken.stl", "stl", "broken")
        depths = {"fat_depth_mm": 0.5 + 0.5 * (skin.vertices[:, 1] > skin.vertices[:, 1].mean())}
        arrays = {"P": skin.vertices, "t": skin.faces.astype(np.float64) + 1}
        scipy.io.savemat(folder / "skin.mat", {**arrays, **depths})
        for side, mouth in CANALS.items():
            canal = make_canal(mouth, (-np.sign(mouth[0]), 0, 0), (0, 1, 0))
            for name in (side, f"{side}_canal"):
                write_mesh(canal, folder / f"{name}.stl", "stl", name)
        (folder / "labels.nii.gz").write_bytes(packed(nifti(nested_labels(), np.diag([4.0, 4.0, 4.0, 1.0]))))
        write_field(skin, folder)
        for name, (radius_mm, beside_mm) in TISSUES.items():
            write_mesh(moved(ball(radius_mm, 2), beside_mm, 0, 0), folder / f"{name}.stl", "stl", name)
        with Client(url) as client:
            mesh = client.upload_mesh(folder / "skin.stl", unit="mm", name="skin")
            volume = client.upload_mesh(folder / "labels.nii.gz", unit="mm", name="labels")
            job = client.shells(mesh, {"fat": 1.0, "average_body": 3.0})
            client.download(job, "package", folder / "package.zip")
            for name in ("fat", "shell_1mm"):
                client.download(job, "fat", folder / f"{name}.stl")
            if is_body:
                write_mesh(grown_together(arms_lowered(40.0)), folder / "arms_down.stl", "stl", "arms_down")
                write_donor(client, mesh.href, folder / "shell_0.3mm.stl")
        files = {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
        return cls(url, files, mesh.id, job.id, volume.id)

    def run_page(self, blocks: Iterable[Block], folder: Path) -> subprocess.CompletedProcess[str]:
        """All blocks in one shell that stops at the first error; `@@ page:line` goes before the output of each."""
        for name, content in self.files.items():
            (folder / name).write_bytes(content)
        script = ["set -euo pipefail"]
        for block in blocks:
            script += [f"echo '@@ {block.place}'", self._lines(block, folder)]
        (folder / "page.sh").write_text("\n".join(script))
        return subprocess.run(
            ["bash", "page.sh"], cwd=folder, env=self._environment(folder), capture_output=True, text=True, timeout=PAGE_S
        )

    def uploaded(self, file_name: str) -> dict[str, str]:
        """A link to one of the files, which gives it its name."""
        with TemporaryDirectory() as folder, Client(self.url) as client:
            path = Path(folder) / file_name
            path.write_bytes(self.files[file_name])
            return {"href": client.upload_mesh(path, unit="mm", name=path.stem).href}

    def filled(self, text: str, mesh: str | None = None) -> str:
        """Addresses and ids that a reader has to put in; `mesh` for the upload's, without it that of the skin."""
        for address in ADDRESSES:
            text = text.replace(address, self.url)
        text = re.sub(r"/v1/meshes/(\{\w+\}|…)", f"/v1/meshes/{mesh or self.mesh}", text)
        return re.sub(r"/v1/jobs/(\{\w+\}|…)", f"/v1/jobs/{self.job}", text)

    def _lines(self, block: Block, folder: Path) -> str:
        if block.language in ("console", "sh"):
            return self.filled(block.commands())
        suffix, command = {"python": ("py", "python"), "matlab": ("m", f"octave-cli --quiet --path '{MATLAB}'")}[block.language]
        program = f"block_{block.line}.{suffix}"
        (folder / program).write_text(self.filled(block.text), encoding="utf-8")
        return f"{command} {program}"

    def _environment(self, folder: Path) -> dict[str, str]:
        kept = {key: value for key, value in os.environ.items() if not key.startswith("INTEGUMENT_")}
        path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
        return {**kept, "PATH": path, "HOME": str(folder), "INTEGUMENT_URL": self.url, "LC_ALL": "C.UTF-8"}


def nested_labels() -> NDArray[np.uint8]:
    """A head of balls: 1 around 2 and 41 around 3 and 42, as the pages number tissues."""
    places = np.moveaxis(np.indices((24, 24, 24)), 0, -1) - 11.5
    far = np.linalg.norm(places, axis=-1)
    labels = np.zeros(far.shape, dtype=np.uint8)
    for radius, left, right in ((10.5, 1, 1), (8.0, 3, 42), (5.0, 2, 41)):
        labels[far < radius] = np.where(places[..., 0] < 0, left, right)[far < radius]
    return labels


def write_field(skin: Mesh, folder: Path) -> None:
    """A coil above the skin, and its field at the skin's vertices: columns as the page of `fields` names them."""
    write_ccd(figure_eight(), folder / "coil.ccd")
    coil = figure_eight().placed(above_head(skin.vertices[skin.vertices[:, 2].argmax()]))
    numbers = np.arange(len(skin.vertices))
    np.savetxt(folder / "field.txt", np.column_stack([numbers, skin.vertices, primary_field(coil, skin.vertices)]))


def write_donor(client: Client, skin: str, path: Path) -> None:
    """The shell whose ears a page grafts."""
    client.download(client.shells(skin, {"fat": 0.3}), "fat", path)


def as_inputs(block: Block, workshop: Workshop) -> dict[str, object]:
    """The inputs object a JSON block of a process page sends, bare or as a whole request."""
    process = Path(block.page).stem
    document = json.loads(workshop.filled(block.text, workshop.volume if process == "segment" else None))
    inputs: dict[str, object] = document.get("inputs", document)
    if process == "detach" and "arms_down.stl" in workshop.files:
        inputs["skin"] = workshop.uploaded("arms_down.stl")
    if process == "ears":
        inputs["canals"] = [workshop.uploaded(f"{side}_canal.stl") for side in CANALS]
    if process == "separate":
        inputs["meshes"] = {name: workshop.uploaded(f"{name}.stl") for name in ("skull", "grey", "white")}
    if process == "fields":
        inputs["field"], inputs["coil"]["file"] = workshop.uploaded("field.txt"), workshop.uploaded("coil.ccd")  # type: ignore[index]
    return inputs
