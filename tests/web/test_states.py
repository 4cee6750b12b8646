"""The page where nothing is, where something is wrong, for every reader and on small screens."""

from __future__ import annotations

import re
from datetime import timedelta
from pathlib import Path

import pytest
from playwright.sync_api import Browser, expect

from store.api_keys import ApiKeys
from store.job import JobFailure
from store.scope import Scope
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, serving
from tests.core.io.stl_bytes import binary_stl
from tests.valkey import ValkeyServer
from tests.web.browser import DESK, PHONE, visit, write

HOSTILE = "<img src=x onerror=alert(1)>"


@pytest.mark.parametrize("place", ["", "new", "jobs", "cohorts", "nowhere", "jobs/{failed}", "compare?a={failed}&b={waiting}"])
def test_every_page_is_usable_and_fits(api: Live, browser: Browser, place: str) -> None:
    failed = api.failed(JobFailure("heal.unsound", "input", "the skin crosses itself at 3 places", retryable=False), report=False)
    waiting = api.accepted()
    with visit(browser, api.url) as seen:
        seen.page.goto(f"/#/{place.format(failed=failed.id, waiting=waiting.id)}")
        expect(seen.page.get_by_role("heading", level=1)).to_be_visible()
        seen.page.wait_for_load_state("load" if place == "jobs" else "networkidle")
        assert seen.barriers_everywhere() == []
        seen.page.set_viewport_size(PHONE)  # type: ignore[arg-type]
        seen.page.emulate_media(color_scheme="dark")
        seen.picture(f"state-{re.sub('[^a-z].*', '', place) or 'meshes'}-390-dark")


@pytest.mark.slow
def test_every_form_is_usable_and_fits(api: Live, browser: Browser) -> None:
    processes = [one["id"] for one in api.client.get("/v1/processes").json()["processes"]]
    assert len(processes) > 10
    with visit(browser, api.url) as seen:
        found = {}
        for process in processes:
            seen.page.set_viewport_size(DESK)  # type: ignore[arg-type]
            seen.page.goto(f"/#/jobs?before={process}")
            seen.page.goto(f"/#/new?process={process}")
            expect(seen.page.get_by_label("Process")).to_have_value(process)
            expect(seen.page.get_by_role("region", name="Inputs")).to_be_visible()
            for group in seen.page.get_by_role("checkbox", name="Use it").all():
                group.check()  # with all that may be left out
            found[process] = seen.barriers()
            seen.page.set_viewport_size(PHONE)  # type: ignore[arg-type]
            if seen.page.evaluate("document.documentElement.scrollWidth") > PHONE["width"]:
                found[process].append("sticks out to the side")
        assert not any(found.values()), found


def test_hostile_names_are_text(api: Live, browser: Browser, tmp_path: Path) -> None:
    path = write(tmp_path / f"{HOSTILE.replace('/', '')}.stl", binary_stl())
    with visit(browser, api.url) as seen:
        seen.page.goto("/")
        seen.page.get_by_label("Files to upload").set_input_files(path)
        expect(seen.page.get_by_text(HOSTILE).first).to_be_visible()
        seen.page.get_by_label("Unit of the coordinates in the file").select_option("mm")
        seen.page.get_by_role("button", name="Use this mesh").click()
        expect(seen.page.get_by_role("link", name="Set up a job").first).to_be_visible()
        sent = api.client.post("/v1/meshes", data={"name": HOSTILE}, files={"file": ("a.stl", binary_stl())})
        assert sent.status_code == 201
        seen.page.reload()
        expect(seen.page.locator(".name").first).to_contain_text("img")
        seen.page.goto(f"/#/new?mesh={sent.json()['id']}")
        expect(seen.page.get_by_label("Skin", exact=True)).to_contain_text("img")
        assert seen.page.locator("img[src='x']").count() == 0
        api.client.delete(f"/v1/meshes/{sent.json()['id']}")


def test_what_is_no_mesh_is_refused_in_words(api: Live, browser: Browser, tmp_path: Path) -> None:
    with visit(browser, api.url) as seen:
        seen.page.goto("/")
        seen.page.get_by_label("Files to upload").set_input_files(write(tmp_path / "notes.stl", b"<script>alert(1)</script>" * 9))
        expect(seen.page.get_by_text("Received.")).to_be_visible()
        seen.page.get_by_label("Unit of the coordinates in the file").select_option("mm")
        seen.page.get_by_role("button", name="Use this mesh").click()
        expect(seen.page.get_by_role("alert").locator(".mono")).to_have_text(re.compile(r"^[a-z]+\.[a-z_]+$"))
        seen.picture("state-refused")


def test_what_the_server_refuses_stands_at_its_input(api: Live, browser: Browser) -> None:
    mesh = api.mesh_href(binary_stl())
    with visit(browser, api.url) as seen:
        seen.page.goto(f"/#/new?mesh={mesh.rpartition('/')[2]}")
        seen.page.get_by_label("Name of layer 1").fill("two words")
        seen.page.get_by_role("button", name="Start the job").click()
        expect(seen.page.get_by_role("alert").first).to_contain_text("pattern")
        seen.picture("state-violation")


def test_a_waiting_job_can_be_dismissed_and_run_again(api: Live, browser: Browser) -> None:
    job = api.accepted()
    with visit(browser, api.url) as seen:
        seen.page.goto(f"/#/jobs/{job.id}")
        expect(seen.page.get_by_text("Waits for a worker", exact=True)).to_be_visible()
        seen.page.get_by_role("button", name="Dismiss").click()
        expect(seen.page.get_by_text("dismissed", exact=True)).to_be_visible()
        seen.page.get_by_role("button", name="Retry").click()
        expect(seen.page.get_by_text("Waits for a worker", exact=True)).to_be_visible()
    api.services.jobs.dismiss(DEFAULT_WORKSPACE, job.id)


def test_a_job_that_is_not_there_is_said_so(api: Live, browser: Browser) -> None:
    with visit(browser, api.url) as seen:
        seen.page.goto("/#/jobs/00000000-0000-4000-8000-000000000000")
        expect(seen.page.get_by_role("alert")).to_contain_text("job.not_found")


def test_keys_are_asked_for_and_kept_for_the_tab(browser: Browser, tmp_path: Path, shared_valkey: ValkeyServer) -> None:
    settings = Settings(data_dir=tmp_path, broker_url=shared_valkey.url, queue="tests-page-keys", require_keys="true")
    with serving(settings) as live, visit(browser, live.url) as seen:
        key = ApiKeys(live.services.db).create(DEFAULT_WORKSPACE, "page", Scope, timedelta(days=1)).text
        seen.page.goto("/")
        seen.page.get_by_role("button", name="Enter an API key").click()
        assert seen.barriers() == []
        seen.picture("state-key")
        seen.page.get_by_label("Key", exact=True).fill(key)
        seen.page.get_by_role("button", name="Use this key").click()
        expect(seen.page.get_by_role("heading", name="Drop the surface of a body here")).to_be_visible()
        seen.page.reload()
        expect(seen.page.get_by_role("heading", name="Drop the surface of a body here")).to_be_visible()
        assert key not in seen.page.url
        assert seen.page.evaluate("JSON.stringify(localStorage)").count(key) == 0
        assert seen.page.evaluate("document.cookie") == ""


def test_a_server_that_went_away_is_said_so_until_it_is_back(api: Live, browser: Browser) -> None:
    with visit(browser, api.url) as seen:
        seen.page.goto("/#/jobs")
        expect(seen.page.get_by_role("heading", name="Jobs")).to_be_visible()
        seen.page.context.set_offline(True)
        expect(seen.page.get_by_text("What is on this page may be old")).to_be_visible()
        seen.picture("state-away")
        seen.page.context.set_offline(False)
        expect(seen.page.get_by_text("What is on this page may be old")).to_be_hidden()
