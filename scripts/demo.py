"""The main job on the real human body, from an empty data folder to a package that is checked again from its files.

Starts the embedded service on a free loopback port, sends the body through the REST queue, fetches the package and the
report, proves the files from the zip in this process, prints the verdict, and stops the service.
Exit codes: 0 only if the job is ready and every check of the files agrees; 1 if not; 130 after Ctrl-C.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from integument import Client, EmbeddedServer, IntegumentError, Job, JobFailedError, ProblemError, Report
from integument.cli.progress import ProgressView, choose_view
from integument.cli.verdict_table import finding_lines, mesh_table
from rich.console import Console

from core.io.registry import write_mesh
from core.package.read import read_shells
from core.validation.validate import Validation, validate
from subjects.body import body

OUT = Path(__file__).resolve().parent.parent / "out" / "demo"
LAYERS_MM = {"fat": 1.0, "average_body": 3.0}
TETGEN_LIMIT_S = 600
MIN_GAP_MM = 0.02  # what two shells keep between them whatever the anatomy


@dataclass(frozen=True, slots=True)
class Checked:
    """The finished job, its report, and what this process found in the files of the zip."""

    job: Job
    report: Report
    files: Validation
    recheck_s: float
    tetrahedra: int
    """How many TetGen fills the three shells with, from the same files; 0 if it refuses them."""

    def as_found_in_files(self) -> Report:
        """The job's report with meshes and pairs replaced by what the files themselves say."""
        meshes = {name: mesh.model_dump(mode="json") for name, mesh in self.files.meshes.items()}
        pairs = [pair.model_dump(mode="json") for pair in self.files.pairs]
        return Report.read({**self.report.as_json(), "meshes": meshes, "pairs": pairs}, "the report")

    def complaints(self) -> list[str]:
        """Why this is no success; empty if it is one."""
        found = [f"the job's verdict is {self.job.verdict}"] if not self.job.ready else []
        expected = {"skin", *LAYERS_MM}
        if set(self.files.meshes) != expected:
            found.append(f"the zip holds {sorted(self.files.meshes)}, not {sorted(expected)}")
        if self.files.verdict != "simulation_ready":
            found.append(f"checked again, the files are {self.files.verdict}")
        if not self.tetrahedra:
            found.append("TetGen refuses the files")
        return found


def main() -> int:
    """Run the demo; returns the exit code."""
    options = _options()
    console = Console() if sys.stdout.isatty() else Console(width=160)
    signal.signal(signal.SIGTERM, _interrupt)  # so that the service is stopped as after Ctrl-C
    started = time.monotonic()
    try:
        _clear(OUT)
        checked = _run(options.subdivisions, console)
    except JobFailedError as error:
        console.print(f"{error}", style="red", markup=False)
        for name in ("report.html", "data/logs"):
            if (OUT / name).exists():
                console.print(f"See {OUT / name}", markup=False, soft_wrap=True)
        return 1
    except IntegumentError as error:
        console.print(f"{type(error).__name__}: {error}", style="red", markup=False)
        console.print(f"The logs of the service are in {OUT / 'data' / 'logs'}", markup=False, soft_wrap=True)
        return 1
    except KeyboardInterrupt:
        console.print("interrupted; the service is stopped")
        return 130
    _show(checked, console, time.monotonic() - started)
    return 1 if checked.complaints() else 0


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="The main job on the real human body; leaves its files in out/demo.")
    parser.add_argument(
        "--subdivisions",
        type=int,
        choices=(0, 1, 2),
        default=1,
        help="size of the body: 0 = 26,756 faces, 1 = 107,024, 2 = 428,096; also DEMO_SUBDIVISIONS [%(default)s]",
    )
    from_environment = os.environ.get("DEMO_SUBDIVISIONS")
    preset = [f"--subdivisions={from_environment}"] if from_environment else []
    return parser.parse_args([*preset, *sys.argv[1:]])


def _interrupt(_number: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def _clear(out: Path) -> None:
    """A fresh folder. Raises: IntegumentError if another demo is working in it."""
    if EmbeddedServer(out / "data").folder.running_url() is not None:
        raise IntegumentError(f"a service is still running in {out / 'data'}; wait until the other demo has ended")
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)


def _run(subdivisions: int, console: Console) -> Checked:
    skin = body(subdivisions)
    skin_path = OUT / "body.stl"
    write_mesh(skin, skin_path, "stl", "body")
    console.print(f"The body: {len(skin.faces):,} faces, {skin_path.stat().st_size / 1e6:.1f} MB binary STL", highlight=False)
    with ExitStack() as stack:
        with console.status("starting the service ..."):
            server = stack.enter_context(EmbeddedServer(OUT / "data"))
        stack.callback(console.print, "stopping the service ...")
        client = stack.enter_context(Client(server.url))
        console.print(f"The service answers at {server.url}", highlight=False)
        job = _submit_and_wait(client, skin_path, choose_view(console))
        client.download(job, "package", OUT / "package.zip")
        report = client.report(job)
        (OUT / "report.html").write_text(client.report_html(job), encoding="utf-8")
    console.print("checking the files in the zip again, from nothing but their bytes ...")
    begun = time.monotonic()
    files = validate(read_shells(OUT / "package.zip"), min_gap_mm=MIN_GAP_MM)
    recheck_s = time.monotonic() - begun
    console.print("giving all three shells together to TetGen ...")
    return Checked(job, report, files, recheck_s, _count_tetrahedra(OUT / "package.zip"))


def _count_tetrahedra(package: Path) -> int:
    command = [sys.executable, str(Path(__file__).with_name("tetrahedralize_package.py")), str(package)]
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=TETGEN_LIMIT_S, check=True)
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
        print(error, file=sys.stderr)
        return 0
    return int(done.stdout.split()[-1])


def _submit_and_wait(client: Client, skin_path: Path, view: ProgressView) -> Job:
    with view:
        mesh = client.upload_mesh(skin_path, unit="mm", name="body", on_bytes=view.transfer("upload"))
        layers = [{"name": name, "depth_mm": depth_mm} for name, depth_mm in LAYERS_MM.items()]
        job = client.execute("shells", {"skin": {"href": mesh.href}, "layers": layers, "thin_policy": "adapt"})
        try:
            return client.wait(job, view.on_event)
        except JobFailedError as error:
            with suppress(ProblemError):  # it may have ended before there was anything to report
                (OUT / "report.html").write_text(client.report_html(error.job), encoding="utf-8")
            raise


def _show(checked: Checked, console: Console, total_s: float) -> None:
    console.print(mesh_table(checked.as_found_in_files()))
    for line in finding_lines(checked.report.findings):
        console.print(line, soft_wrap=True)
    timings = ", ".join(f"{phase} {seconds:.1f} s" for phase, seconds in (checked.job.timings_s or {}).items())
    job_s = checked.job.seconds or 0.0
    console.print(
        f"Job {job_s:.1f} s ({timings}); files checked again in {checked.recheck_s:.1f} s; all in all {total_s:.1f} s",
        highlight=False,
        soft_wrap=True,
    )
    console.print(f"TetGen (pYQ) fills the shells with {checked.tetrahedra:,} tetrahedra", highlight=False)
    complaints = checked.complaints()
    if complaints:
        console.print(f"not accepted: {'; '.join(complaints)}", style="bold red", markup=False, highlight=False)
    else:
        console.print("simulation_ready, in the service and again from the files", style="bold green")
    console.print(f"Package: {OUT / 'package.zip'}", markup=False, highlight=False, soft_wrap=True)
    console.print(f"Report:  {OUT / 'report.html'}", markup=False, highlight=False, soft_wrap=True)


if __name__ == "__main__":
    sys.exit(main())
