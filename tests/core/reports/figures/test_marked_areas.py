"""Areas that findings are about: painted where they are, circled where the findings say, and left out where nothing is."""

import io

import numpy as np
from PIL import Image

from core.geometry.body_frame import find_body_frame
from core.reports.figures.marked_areas import LIMITED, MISSED, MarkedArea, draw_marked_areas
from core.schema.finding import Finding, Place, Severity
from subjects.body import body

BODY = body(0)
FRAME = find_body_frame(BODY)
BELLY = (np.abs(BODY.vertices[:, 0]) < 80) & (np.abs(BODY.vertices[:, 1] - 200) < 60)
NOTHING = np.zeros(len(BODY.vertices), dtype=np.bool_)


def finding(mesh: str) -> Finding:
    return Finding(
        code="shells.depth_limited",
        severity=Severity.INFO,
        message="thin",
        count=7,
        places=(Place(mesh=mesh, point_mm=(0.0, 350.0, 150.0)),),
    )


def count_blue(png: bytes) -> int:
    """Pixels much bluer than red."""
    picture = np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)
    return int((picture[:, :, 2] - picture[:, :, 0] > 60).sum())


def draw(area: MarkedArea, *findings: Finding):
    return draw_marked_areas("fat", BODY, FRAME, (226, 155, 0), (area,), findings)


def test_what_is_limited_is_painted_and_circled() -> None:
    area = MarkedArea("shells.depth_limited", "limited by anatomy", LIMITED, BELLY)
    figure = draw(area, finding("fat"), finding("average_body"))
    assert figure is not None
    assert figure.name == "places_fat"
    assert "limited by anatomy: 7 places" in figure.caption
    assert draw(area, finding("fat"), finding("average_body")) == figure
    without_circle = draw(area, finding("average_body"))
    assert without_circle is not None
    assert count_blue(figure.png) > count_blue(without_circle.png) + 100
    assert count_blue(without_circle.png) > 5000


def test_there_is_no_picture_of_nothing() -> None:
    assert draw(MarkedArea("shells.depth_missed", "off its depth", MISSED, NOTHING), finding("fat")) is None
