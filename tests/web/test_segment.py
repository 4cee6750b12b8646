"""Label volumes on the page: listed by voxels and labels, and a form that knows the labels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from playwright.sync_api import expect

from store.settings import Settings
from tests.api.live import serving
from tests.core.io.nifti_bytes import nifti, packed, two_boxes
from tests.valkey import ValkeyServer
from tests.web.browser import chromium, visit


def test_labels_are_named_in_the_form(tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-page-segment", port=0)
    content = packed(nifti(two_boxes(), np.diag([20.0, 20.0, 20.0, 1.0])))
    with serving(settings) as live, chromium() as browser, visit(browser, live.url) as seen:
        page = seen.page
        page.goto("/")
        page.get_by_label("Files to upload").set_input_files(
            {"name": "head.nii.gz", "mimeType": "application/gzip", "buffer": content}
        )
        page.get_by_role("button", name="Use this mesh").click()
        expect(page.get_by_text("5 × 6 × 7 voxels, 2 labels")).to_be_visible()
        seen.picture("segment-volume")
        page.get_by_role("link", name="Set up a job").click()
        page.get_by_label("Names: name of label 1").fill("skin")
        page.get_by_label("Names: name of label 7").fill("bone")
        page.get_by_label("Islands").select_option("keep_all")
        seen.picture("segment-form")
        assert seen.barriers() == []
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text("Waits for a worker", exact=True)).to_be_visible()
        job = page.url.rpartition("/")[2]
        asked = live.client.get(f"/v1/jobs/{job}/inputs").json()["inputs"]
        assert asked["names"] == {"1": "skin", "7": "bone"}
        assert asked["islands"] == "keep_all"
        assert asked["volume"]["href"].startswith("/v1/meshes/")
