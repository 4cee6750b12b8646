"""A solver's field on the page: the coil placed by a pasted matrix, the magnitude in colours, its value under the pointer."""

from __future__ import annotations

import io
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from PIL import Image
from playwright.sync_api import Page, expect

from subjects.figure_eight import above_head, figure_eight, primary_field, write_ccd
from tests.acceptance.service import binary_stl
from tests.embedded import embedded
from tests.solids import sphere
from tests.web.browser import chromium, visit, write

HEAD = sphere(80.0, 3)
PLACEMENT = above_head(np.array([0.0, 0.0, 80.0]))
KNOWN_ABOVE_MM = -40.0  # below there is no field: triangles without a value
JOB_MS = 120_000


def field_text() -> bytes:
    """Of the coil at the vertices, but for the lowest."""
    points = HEAD.vertices[HEAD.vertices[:, 2] > KNOWN_ABOVE_MM]
    rows = np.column_stack([points, primary_field(figure_eight().placed(PLACEMENT), points)])
    out = io.BytesIO()
    np.savetxt(out, rows, delimiter=",", header="x,y,z,Ex,Ey,Ez", comments="")
    return out.getvalue()


def magnitudes_at(place: list[float], delivered: Path, folder: Path) -> tuple[float, float]:
    """The smallest and the largest in V/m of the triangle at a place in mm, and the two nearest beside it, by the MATLAB file."""
    with zipfile.ZipFile(delivered) as archive:
        file = scipy.io.loadmat(archive.extract("mat/mesh.mat", folder))
    middles = file["P"][file["t"].astype(int) - 1].mean(axis=1)
    nearest = np.linalg.norm(middles - place, axis=1).argsort()[:3]
    return float(file["magE"][nearest].min()), float(file["magE"][nearest].max())


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_a_field_is_seen_and_read(tmp_path: Path) -> None:
    write_ccd(figure_eight(), tmp_path / "coil.ccd")
    with embedded(tmp_path / "data") as server, chromium() as browser, visit(browser, server.url) as seen:
        page = seen.page
        page.goto("/")
        expect(page.get_by_role("heading", name="Drop the surface of a body here")).to_be_visible()
        upload(page, write(tmp_path / "head.stl", binary_stl(HEAD)))
        upload(page, write(tmp_path / "field.csv", field_text()))
        upload(page, tmp_path / "coil.ccd")
        page.goto("/#/new?process=fields")
        choose(page, "Mesh", "head")
        choose(page, "Field", "field")
        page.get_by_role("checkbox", name="Use it").check()
        choose(page, "File", "coil")
        page.get_by_role("button", name="On top of the head").click()
        expect(page.get_by_label("Position in mm: z")).to_have_value("85")
        page.get_by_label("As a matrix").check()
        page.get_by_label("Placement: row 1, column 1").focus()
        paste(page, str(PLACEMENT.tolist()))
        expect(page.get_by_label("Placement: row 3, column 4")).to_have_value(f"{PLACEMENT[2, 3]:g}")
        seen.drawn()
        seen.picture("fields-form")
        assert seen.barriers() == []
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text("✗ not ready")).to_be_visible(timeout=JOB_MS)  # for the triangles without a value
        expect(page.get_by_label("Colours", exact=True)).to_have_value("Magnitude of the field")
        expect(page.get_by_role("img", name=re.compile(r"^Magnitude of the field from 0 to .* V.m$"))).to_be_visible()
        page.get_by_role("button", name="+z", exact=True).click()
        seen.drawn()
        told = read_middle(page)
        found = re.search(r"\((.*)\) mm · Magnitude of the field ([\d.]+) V/m", told)
        assert found is not None, told
        with page.expect_download() as delivered:
            page.get_by_role("button", name="fields.zip").click()
        low, high = magnitudes_at([float(one) for one in found[1].split(",")], delivered.value.path(), tmp_path)
        assert 0.999 * low <= float(found[2]) <= 1.001 * high
        seen.picture("fields-magnitude")
        assert seen.barriers() == []
        page.get_by_role("button", name="−z", exact=True).click()
        seen.drawn()
        assert "has no value here" in read_middle(page)
        view = Image.open(io.BytesIO(page.locator(".viewer canvas").screenshot())).convert("RGB")
        shade = view.getpixel((view.width // 2 + 30, view.height // 2))
        assert isinstance(shade, tuple)
        assert max(shade) - min(shade) <= 8, "grey"


def upload(page: Page, path: Path) -> None:
    page.get_by_label("Files to upload").set_input_files(path)
    item = page.get_by_role("article", name=f"Upload of {path.name}")
    item.get_by_label("Unit of the coordinates in the file").select_option("mm")
    item.get_by_role("button", name="Use this mesh").click()
    expect(item).to_have_count(0)


def choose(page: Page, label: str, name: str) -> None:
    """What is called so, among those the server holds."""
    choice = page.get_by_label(label, exact=True)
    choice.select_option(label=choice.locator("option").filter(has_text=re.compile(f"^{name} ")).inner_text())


def paste(page: Page, text: str) -> None:
    """As a person does, without the clipboard of the machine."""
    page.evaluate(
        """text => {
            const data = new DataTransfer();
            data.setData("text/plain", text);
            document.activeElement.dispatchEvent(
                new ClipboardEvent("paste", { clipboardData: data, bubbles: true, cancelable: true }));
        }""",
        text,
    )


def read_middle(page: Page) -> str:
    """What stands under the pointer in the middle of the view."""
    view = page.locator(".viewer canvas").bounding_box()
    assert view is not None
    x, y = view["x"] + view["width"] / 2, view["y"] + view["height"] / 2
    page.mouse.move(x - 40, y - 40)
    page.mouse.move(x + 5, y + 3, steps=3)
    expect(page.locator(".readout")).to_contain_text("Magnitude of the field")
    return page.locator(".readout").inner_text()
