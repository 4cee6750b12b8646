"""What comes between people and their work: keys that end, servers that go away, another tab. Nothing typed is lost."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from datetime import timedelta
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect
from sqlalchemy import update

from store.api_keys import ApiKeys
from store.records import ApiKeyRow
from store.scope import Scope
from store.settings import Settings
from store.workers import WorkerWord
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live, serving
from tests.core.io.stl_bytes import binary_stl
from tests.valkey import ValkeyServer
from tests.web.browser import chromium, visit, write

BANNER = "What is on this page may be old"
REPORT = (
    b'{"process": "validate", "verdict": "simulation_ready", "summary": "1 mesh, no errors", "meshes": {}, "pairs": [], '
    b'"thickness": {}, "findings": [], "methods": "", "parameters": {}, "software": {}}'
)
NO_ANSWER = "The server does not answer."


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium(names={"lab.test": "127.0.0.1"}) as browser:
        yield browser


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Live]:
    """No worker: what is asked for waits."""
    folder = tmp_path_factory.mktemp("interruptions")
    settings = Settings(
        data_dir=folder, broker_url=shared_valkey.url, queue="tests-interruptions", port=0, allowed_hosts=("lab.test",)
    )
    with serving(settings) as live:
        yield live


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory, shared_valkey: ValkeyServer) -> Iterator[Live]:
    """A server that wants keys."""
    folder = tmp_path_factory.mktemp("locked")
    settings = Settings(data_dir=folder, broker_url=shared_valkey.url, queue="tests-locked", port=0, require_keys="true")
    with serving(settings) as live:
        yield live


def make_key(live: Live) -> tuple[str, str]:
    """Its id and its text."""
    made = ApiKeys(live.services.db).create(DEFAULT_WORKSPACE, "page", Scope, timedelta(days=1))
    return made.key.id, made.text


def revoke(live: Live, key_id: str) -> None:
    """An operator takes it back."""
    ApiKeys(live.services.db).revoke(key_id)


def expire(live: Live, key_id: str) -> None:
    """Its time is over."""
    with live.services.db.session() as session:
        past = live.services.db.now(session) - timedelta(seconds=1)
        session.execute(update(ApiKeyRow).where(ApiKeyRow.id == key_id).values(expires_at=past))


ENDS = [pytest.param(revoke, "access.key_invalid", id="revoked"), pytest.param(expire, "access.key_expired", id="expired")]


def enter_key(page: Page, text: str, *, by: str = "Enter an API key") -> None:
    page.get_by_role("button", name=by).first.click()
    page.get_by_label("Key", exact=True).fill(text)
    page.get_by_role("button", name="Use this key").click()


@pytest.mark.parametrize(("end", "code"), ENDS)
def test_a_key_that_ends_in_mid_form_costs_nothing(
    locked: Live, browser: Browser, end: Callable[[Live, str], None], code: str
) -> None:
    key_id, text = make_key(locked)
    with visit(browser, locked.url) as seen:
        page = seen.page
        page.goto("/#/new")
        enter_key(page, text)
        page.get_by_label("Process").select_option("separate")
        page.get_by_label("Process").select_option("shells")
        page.get_by_label("Name of layer 1").fill("fat_typed")
        page.get_by_label("Depth of layer 1 in mm").fill("1.25")
        page.get_by_role("button", name="Add a layer").click()
        page.get_by_label("Labels, separated by commas").fill("pilot")
        end(locked, key_id)
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_role("alert")).to_contain_text(code)
        seen.picture("key-ended-in-form")
        assert seen.barriers() == []
        enter_key(page, make_key(locked)[1])
        expect(page.get_by_role("alert")).to_have_count(0)
        expect(page.get_by_label("Name of layer 1")).to_have_value("fat_typed")
        expect(page.get_by_label("Depth of layer 1 in mm")).to_have_value("1.25")
        expect(page.get_by_label("Name of layer 3")).to_have_value("layer")
        expect(page.get_by_label("Labels, separated by commas")).to_have_value("pilot")
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_role("alert").first).to_contain_text("field required")  # no skin: the server answers again


@pytest.mark.parametrize(("end", "code"), ENDS)
def test_a_key_that_ends_while_a_job_is_watched(
    locked: Live, browser: Browser, end: Callable[[Live, str], None], code: str
) -> None:
    key_id, text = make_key(locked)
    job = locked.running()
    with visit(browser, locked.url) as seen:
        page = seen.page
        page.goto(f"/#/jobs/{job.id}")
        enter_key(page, text)
        expect(page.get_by_role("progressbar", name="Progress of the job")).to_be_visible()
        end(locked, key_id)
        expect(page.get_by_role("alert")).to_contain_text(code, timeout=40_000)
        expect(page.get_by_role("progressbar", name="Progress of the job")).to_be_visible()  # as it was seen last
        seen.picture("key-ended-at-job")
        enter_key(page, make_key(locked)[1])
        expect(page.get_by_role("alert")).to_have_count(0)
        finish(locked, job.id, job.lease_token)
        expect(page.get_by_text("1 mesh, no errors").first).to_be_visible()


@pytest.mark.parametrize(("end", "code"), ENDS)
def test_an_upload_goes_on_with_another_key(
    locked: Live, browser: Browser, tmp_path: Path, end: Callable[[Live, str], None], code: str
) -> None:
    key_id, text = make_key(locked)
    with visit(browser, locked.url) as seen:
        page = seen.page
        page.goto("/")
        enter_key(page, text)
        expect(page.get_by_role("button", name="Choose files…")).to_be_visible()
        end(locked, key_id)
        page.get_by_label("Files to upload").set_input_files(write(tmp_path / "skin.stl", binary_stl()))
        item = page.get_by_role("article", name="Upload of skin.stl")
        expect(item.get_by_role("alert")).to_contain_text(code)
        item.get_by_label("Unit of the coordinates in the file").select_option("mm")
        enter_key(page, make_key(locked)[1])
        expect(page.get_by_text("Received.")).to_be_visible()
        expect(item.get_by_label("Unit of the coordinates in the file")).to_have_value("mm")
        page.get_by_role("button", name="Use this mesh").click()
        expect(page.get_by_role("link", name="Set up a job")).to_be_visible()


def test_every_tab_has_its_own_key(locked: Live, browser: Browser) -> None:
    with visit(browser, locked.url) as seen:
        first, second = seen.page, seen.page.context.new_page()
        first.goto("/#/jobs")
        enter_key(first, make_key(locked)[1])
        expect(first.get_by_role("alert")).to_have_count(0)
        second.goto("/#/jobs")
        expect(second.get_by_role("alert")).to_contain_text("access.key_missing")
        enter_key(second, "itg_nobody_knows_it", by="API key")
        expect(second.get_by_role("alert")).to_contain_text("access.key_")
        first.reload()
        expect(first.get_by_role("heading", name="Jobs")).to_be_visible()
        expect(first.get_by_role("alert")).to_have_count(0)


def test_what_another_tab_does_is_seen(api: Live, browser: Browser) -> None:
    job = api.accepted()
    with visit(browser, api.url) as seen:
        first, second = seen.page, seen.page.context.new_page()
        for page in (first, second):
            page.goto(f"/#/jobs/{job.id}")
            expect(page.get_by_text("Waits for a worker", exact=True)).to_be_visible()
        second.get_by_role("button", name="Dismiss").click()
        for page in (first, second):
            expect(page.get_by_text("dismissed", exact=True)).to_be_visible()
        for _ in range(2):
            second.get_by_role("button", name="emove with its results").click()
        expect(second.get_by_role("heading", name="Jobs")).to_be_visible()
        first.get_by_role("button", name="Retry").click()
        expect(first.get_by_role("alert").first).to_contain_text("job.not_found")


def test_a_job_that_ends_before_it_is_dismissed_keeps_its_results(api: Live, browser: Browser) -> None:
    job = api.running()
    with visit(browser, api.url) as seen:
        page = seen.page
        page.route("**/events", lambda route: route.abort())  # this page does not hear that it ends
        page.goto(f"/#/jobs/{job.id}")
        expect(page.get_by_role("button", name="Dismiss")).to_be_visible()
        finish(api, job.id, job.lease_token)
        page.get_by_role("button", name="Dismiss").click()
        expect(page.get_by_text("1 mesh, no errors").first).to_be_visible()
        assert api.services.jobs.get(DEFAULT_WORKSPACE, job.id).status == "successful"


@pytest.mark.parametrize("place", ["", "new", "jobs", "cohorts", "jobs/{job}", "compare?a={job}&b={job}"])
def test_pages_come_back_with_the_server(api: Live, browser: Browser, place: str) -> None:
    api.mesh_href(binary_stl())
    job = api.successful({"report": (REPORT, "application/json", "report.json")})
    with visit(browser, api.url) as seen:
        page = seen.page
        page.goto("/#/nowhere")
        expect(page.get_by_role("heading", name="There is no such page")).to_be_visible()
        page.context.set_offline(True)
        page.goto(f"/#/{place.format(job=job.id)}")
        expect(page.get_by_text(BANNER)).to_be_visible()
        expect(page.get_by_text(NO_ANSWER, exact=True).first).to_be_visible()
        seen.picture(f"away-{place.split('?')[0].replace('/{job}', '') or 'meshes'}")
        assert seen.barriers() == []
        page.context.set_offline(False)
        expect(page.get_by_text(BANNER)).to_be_hidden()
        expect(page.get_by_role("alert")).to_have_count(0)
        expect(page.get_by_role("heading", level=1)).to_be_visible()
        expect(page.get_by_text("Loading")).to_have_count(0)


def test_pages_say_that_no_worker_is_there_until_one_comes(api: Live, browser: Browser) -> None:
    job = api.accepted()
    with visit(browser, api.url) as seen:
        seen.page.goto(f"/#/jobs/{job.id}")
        expect(seen.page.get_by_text("no worker has given word lately; jobs are accepted, and wait")).to_be_visible()
        expect(seen.page.get_by_text("Waits for a worker", exact=True)).to_be_visible()
        seen.picture("away-worker")
        assert seen.barriers() == []
        api.services.workers.beat(WorkerWord("a:1", "a", "0.1.0", 2, 16 * 1024**3, 10**11))
        expect(seen.page.get_by_text("no worker has given word lately")).to_be_hidden()
    api.services.workers.leave("a:1")


def test_a_form_and_an_upload_outlast_a_server_that_is_away(api: Live, browser: Browser, tmp_path: Path) -> None:
    mesh = api.mesh_href(binary_stl())
    with visit(browser, api.url) as seen:
        page = seen.page
        page.goto(f"/#/new?mesh={mesh.rpartition('/')[2]}")
        page.get_by_label("Depth of layer 1 in mm").fill("1.75")
        page.context.set_offline(True)
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text(NO_ANSWER, exact=True)).to_be_visible()
        page.context.set_offline(False)
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text("Waits for a worker", exact=True)).to_be_visible()
        asked = api.client.get(f"/v1/jobs/{page.url.rpartition('/')[2]}/inputs").json()["inputs"]
        assert asked["layers"][0]["depth_mm"] == 1.75
        page.goto("/#/")
        expect(page.get_by_role("button", name="Choose files…")).to_be_visible()
        page.context.set_offline(True)
        page.get_by_label("Files to upload").set_input_files(write(tmp_path / "late.stl", binary_stl()))
        expect(page.get_by_role("article", name="Upload of late.stl")).to_be_visible()
        page.context.set_offline(False)
        expect(page.get_by_text("Received.")).to_be_visible()


def test_an_answer_that_was_lost_makes_no_second_job(api: Live, browser: Browser) -> None:
    mesh = api.mesh_href(binary_stl())
    before = len(api.client.get("/v1/jobs", params={"limit": 500}).json()["jobs"])
    with visit(browser, api.url) as seen:
        page = seen.page
        page.goto(f"/#/new?mesh={mesh.rpartition('/')[2]}")
        expect(page.get_by_label("Depth of layer 1 in mm")).to_be_visible()
        page.route("**/execution", lambda route: (route.fetch(), route.abort())[0])  # it arrives, its answer does not
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text(NO_ANSWER, exact=True)).to_be_visible()
        page.unroute("**/execution")
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text("Waits for a worker", exact=True)).to_be_visible()
    assert len(api.client.get("/v1/jobs", params={"limit": 500}).json()["jobs"]) == before + 1


def test_a_lab_server_without_tls_starts_jobs(api: Live, browser: Browser) -> None:
    """Browsers keep some of their functions for https and for their own machine."""
    mesh = api.mesh_href(binary_stl())
    with visit(browser, api.url.replace("127.0.0.1", "lab.test")) as seen:
        page = seen.page
        page.goto(f"/#/new?mesh={mesh.rpartition('/')[2]}")
        assert page.evaluate("isSecureContext") is False
        page.get_by_role("button", name="Start the job").click()
        expect(page.get_by_text("Waits for a worker", exact=True)).to_be_visible()


def test_a_page_that_cannot_be_drawn_says_so(api: Live, browser: Browser) -> None:
    job = api.successful({"report": (b"{}", "application/json", "report.json")})  # no report of ours
    with visit(browser, api.url) as seen:
        seen.page.goto(f"/#/jobs/{job.id}")
        expect(seen.page.get_by_role("heading", name="This page cannot be shown")).to_be_visible()
        seen.page.get_by_role("link", name="To the jobs").click()
        expect(seen.page.get_by_role("heading", name="Jobs")).to_be_visible()
        assert any("null to object" in one for one in seen.wrong)
        seen.wrong.clear()  # it was told to the console


def finish(live: Live, job_id: str, lease_token: int) -> None:
    """As a worker does."""
    outputs = {"report": live.stored(REPORT, "application/json", "report.json")}
    kept = live.services.jobs.finish(
        job_id,
        lease_token,
        verdict="simulation_ready",
        summary="1 mesh, no errors",
        outputs=outputs,
        timings_s={},
        peak_memory_bytes=1,
    )
    assert kept
