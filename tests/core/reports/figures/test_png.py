from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from core.reports.figures.png import encode_png


@pytest.mark.parametrize(("shape", "mode"), [((1, 1, 3), "P"), ((7, 5, 4), "P"), ((300, 211, 3), "RGB")])
def test_another_reader_finds_the_same_pixels(shape: tuple[int, int, int], mode: str) -> None:
    picture = np.random.default_rng(7).integers(0, 256, shape, dtype=np.uint8)
    with Image.open(io.BytesIO(encode_png(picture))) as image:
        image.load()
        assert (image.format, image.mode, image.size) == ("PNG", mode, (shape[1], shape[0]))
        assert np.array_equal(np.asarray(image.convert("RGB")), picture[:, :, :3])
        assert not {*image.info} - {"transparency"}


def test_flat_colour_takes_next_to_nothing_and_always_the_same() -> None:
    picture = np.full((1000, 1000, 3), 200, dtype=np.uint8)
    assert len(encode_png(picture)) < 10_000
    assert encode_png(picture) == encode_png(picture.copy())
