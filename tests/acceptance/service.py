"""A server seen through its HTTP interface and nothing else."""

from __future__ import annotations

import io
import time
import zipfile
from collections.abc import Callable, Mapping
from typing import Any

import httpx
import numpy as np
from numpy.typing import NDArray

from api.schemas.job_report import JobReport
from core.mesh import Mesh

LIMIT_S = 240.0
LOOK_S = 0.1
FINISHED = ("successful", "failed", "dismissed")
FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


class Service:
    """Uploads, jobs and results of the server at `url`."""

    def __init__(self, url: str, key: str = "") -> None:
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        self.http = httpx.Client(base_url=url, timeout=60, trust_env=False, headers=headers)

    def close(self) -> None:
        """Let go of the connections."""
        self.http.close()

    def upload(self, mesh: Mesh, name: str = "skin") -> str:
        """Send as binary STL in mm; the reference to it."""
        return self.upload_file(binary_stl(mesh), f"{name}.stl", "mm")

    def upload_file(self, content: bytes, file_name: str, unit: str) -> str:
        """Send as it is; the reference to it."""
        data = {"unit": unit, "name": file_name.partition(".")[0]}
        reply = self.http.post("/v1/meshes", data=data, files={"file": (file_name, content, "application/octet-stream")})
        assert reply.status_code == 201, reply.text
        return f"/v1/meshes/{reply.json()['id']}"

    def execute(self, process: str, inputs: Mapping[str, Any]) -> str:
        """The id of the job."""
        reply = self.http.post(f"/v1/processes/{process}/execution", json={"inputs": inputs})
        assert reply.status_code == 201, reply.text
        assert reply.headers["Location"] == f"/v1/jobs/{reply.json()['jobID']}"
        return str(reply.json()["jobID"])

    def shells(self, skin: str, **inputs: Any) -> str:
        """A job with the default layers unless said otherwise."""
        return self.execute("shells", {"skin": {"href": skin}, **inputs})

    def status(self, job: str) -> dict[str, Any]:
        """statusInfo."""
        reply = self.http.get(f"/v1/jobs/{job}")
        assert reply.status_code == 200, reply.text
        found: dict[str, Any] = reply.json()
        return found

    def wait(
        self, job: str, until: Callable[[dict[str, Any]], bool] | None = None, *, limit_s: float = LIMIT_S
    ) -> dict[str, Any]:
        """The first status of which `until` is true; by default, the last one."""
        deadline = time.monotonic() + limit_s
        while True:
            status = self.status(job)
            if until(status) if until else status["status"] in FINISHED:
                return status
            assert until is None or status["status"] not in FINISHED, status
            assert time.monotonic() < deadline, status
            time.sleep(LOOK_S)

    def succeed(self, job: str, *, limit_s: float = LIMIT_S) -> dict[str, Any]:
        """The last status of a job that has to end well."""
        status = self.wait(job, limit_s=limit_s)
        assert status["status"] == "successful", status
        return status

    def result(self, job: str, output: str) -> bytes:
        """An output as bytes, by way of the document of results."""
        reply = self.http.get(f"/v1/jobs/{job}/results")
        assert reply.status_code == 200, reply.text
        file = self.http.get(reply.json()[output]["href"])
        assert file.status_code == 200, file.text
        return file.content

    def report(self, job: str) -> dict[str, Any]:
        """As JSON, of the form the API promises."""
        reply = self.http.get(f"/v1/jobs/{job}/report", headers={"Accept": "application/json"})
        assert reply.status_code == 200, reply.text
        JobReport.model_validate_json(reply.text)
        found: dict[str, Any] = reply.json()
        return found


def binary_stl(mesh: Mesh) -> bytes:
    """Written without the product's own writer."""
    facets = np.zeros(len(mesh.faces), FACET)
    facets["corners"] = mesh.vertices[mesh.faces]
    return bytes(80) + np.uint32(len(facets)).tobytes() + facets.tobytes()


def read_stl(data: bytes) -> Mesh:
    """Read without the product's own reader; corners at the same place become one vertex."""
    facets = np.frombuffer(data, FACET, offset=84)
    assert len(facets) == int.from_bytes(data[80:84], "little")
    corners: NDArray[np.float64] = facets["corners"].reshape(-1, 3).astype(np.float64)
    vertices, faces = np.unique(corners, axis=0, return_inverse=True)
    return Mesh.of(vertices, faces.reshape(-1, 3))


def unpack_shells(package: bytes) -> dict[str, Mesh]:
    """The surfaces of a package by the name of their STL file."""
    with zipfile.ZipFile(io.BytesIO(package)) as archive:
        assert archive.testzip() is None
        names = [name for name in archive.namelist() if name.startswith("stl/") and name.endswith(".stl")]
        return {name.removeprefix("stl/").removesuffix(".stl"): read_stl(archive.read(name)) for name in names}
