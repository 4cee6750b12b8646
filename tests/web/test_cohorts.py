"""Search and labels of the lists, and cohorts in the page: chosen, watched, taken back; names are text."""

from __future__ import annotations

from playwright.sync_api import Browser, expect

from store.job_words import JobWords
from store.workspace import DEFAULT_WORKSPACE
from tests.api.live import Live
from tests.api.test_cohorts import zipped
from tests.core.io.stl_bytes import binary_stl
from tests.web.browser import visit

HOSTILE = "<img src=x onerror=alert(1)>"


def test_jobs_are_found_beyond_those_that_are_shown(api: Live, browser: Browser) -> None:
    jobs = api.services.jobs
    wanted = jobs.create(DEFAULT_WORKSPACE, "validate", {}, words=JobWords(f"needle {HOSTILE}", ("pilot", HOSTILE)))
    for number in range(60):
        jobs.create(DEFAULT_WORKSPACE, "validate", {}, words=JobWords(f"hay {number}"))
    with visit(browser, api.url) as seen:
        seen.page.goto("/#/jobs")
        expect(seen.page.get_by_text("hay 59")).to_be_visible()
        expect(seen.page.get_by_text(wanted.id[:8])).to_have_count(0)
        seen.page.get_by_placeholder("Search").fill("NEEDLE")
        expect(seen.page.get_by_text(wanted.id[:8])).to_be_visible()
        expect(seen.page.get_by_text("hay 59")).to_have_count(0)
        seen.page.get_by_role("button", name="pilot").click()
        seen.page.get_by_placeholder("Search").fill("")
        expect(seen.page.get_by_role("button", name="No longer only pilot")).to_be_visible()
        seen.page.get_by_role("link", name="validate").click()
        expect(seen.page.get_by_text(f"needle {HOSTILE}").first).to_be_visible()
        seen.page.get_by_text("Name and labels").click()
        seen.page.get_by_label("Labels, separated by commas").fill("ages, pilot")
        seen.page.get_by_role("button", name="Save").click()
        expect(seen.page.get_by_role("link", name="ages")).to_be_visible()
        assert seen.page.locator("img[src='x']").count() == 0
        assert seen.barriers() == []
    assert jobs.get(DEFAULT_WORKSPACE, wanted.id).labels == ("ages", "pilot")


def test_a_cohort_is_chosen_watched_and_taken_back(api: Live, browser: Browser) -> None:
    for name in ("Anna", HOSTILE):
        assert api.client.post("/v1/meshes", data={"name": name}, files={"file": ("a.stl", binary_stl())}).status_code == 201
    with visit(browser, api.url) as seen:
        seen.page.goto("/#/cohorts")
        expect(seen.page.get_by_text("No cohorts yet")).to_be_visible()
        seen.page.get_by_label("Name", exact=True).fill("Pilot")
        seen.page.get_by_label("Process", exact=True).select_option("validate")
        seen.page.get_by_label("Min gap (mm)").fill("0.2")
        seen.page.get_by_text("Meshes of the server").first.click()
        for name in ("Anna", HOSTILE):
            seen.page.get_by_label(name).check()
        assert seen.barriers() == []
        seen.page.get_by_role("button", name="Start the cohort").click()
        expect(seen.page.get_by_role("heading", name="Pilot")).to_be_visible()
        expect(seen.page.get_by_role("link", name=HOSTILE)).to_be_visible()
        assert seen.page.locator("img[src='x']").count() == 0
        assert seen.barriers() == []
        seen.page.get_by_role("button", name="Dismiss").click()
        expect(seen.page.get_by_role("button", name="Retry what failed")).to_be_visible()
        seen.picture("cohort")
        seen.page.goto("/#/cohorts")
        expect(seen.page.get_by_role("link", name="Pilot")).to_be_visible()
    [cohort] = api.services.cohorts.list(DEFAULT_WORKSPACE).items
    assert cohort.inputs == {"min_gap_mm": 0.2}
    assert {job.subject for job in api.services.cohorts.jobs(DEFAULT_WORKSPACE, cohort.id)} == {"Anna", HOSTILE}


def test_files_are_sent_and_those_that_are_no_mesh_are_left_out(api: Live, browser: Browser) -> None:
    good = binary_stl()
    files = [("Bert.stl", good), (f"{HOSTILE.replace('/', '')}.stl", b"no mesh"), ("Carla.stl", good)]
    with visit(browser, api.url) as seen:
        seen.page.goto("/#/cohorts")
        seen.page.get_by_label("Files to upload").set_input_files(
            [{"name": name, "mimeType": "model/stl", "buffer": content} for name, content in files]
        )
        expect(seen.page.get_by_text("Say the unit of the files.")).to_be_visible()
        seen.page.get_by_label("Unit of the coordinates in the files").select_option("m")
        expect(seen.page.get_by_text("unlike a human").first).to_be_visible()
        seen.page.get_by_label("Unit of the coordinates in the files").select_option("mm")
        expect(seen.page.get_by_text("unlike a human")).to_have_count(0)
        expect(seen.page.get_by_text("Left out: ")).to_be_visible()
        expect(seen.page.get_by_text("2 subjects.")).to_be_visible()
        assert seen.barriers() == []
        seen.picture("cohort-files")
        seen.page.get_by_role("button", name="Start the cohort").click()
        expect(seen.page.get_by_role("link", name="Carla")).to_be_visible()
        assert seen.page.locator("img[src='x']").count() == 0
    cohort = api.services.cohorts.list(DEFAULT_WORKSPACE).items[0]
    assert [job.subject for job in api.services.cohorts.jobs(DEFAULT_WORKSPACE, cohort.id)] == ["Bert", "Carla"]


def test_a_zip_comes_in_pieces_and_not_again_when_its_settings_were_refused(api: Live, browser: Browser) -> None:
    buffer = zipped({"cleo.stl": binary_stl(), "torn.stl": b"no mesh"})
    with visit(browser, api.url) as seen:
        uploads: list[str] = []
        seen.page.on("request", lambda sent: uploads.append(sent.url) if sent.method == "PATCH" else None)
        seen.page.goto("/#/cohorts")
        seen.page.locator("input[type=file]").first.set_input_files(
            {"name": "study.zip", "mimeType": "application/zip", "buffer": buffer}
        )
        seen.page.get_by_label("Unit of the coordinates").select_option("cm")
        seen.page.get_by_label("Name", exact=True).fill("Zipped")
        seen.page.get_by_label("Process", exact=True).select_option("graft")
        seen.page.get_by_role("button", name="Start the cohort").click()
        expect(seen.page.get_by_text("inputs.invalid").first).to_be_visible()
        seen.page.get_by_label("Process", exact=True).select_option("validate")
        seen.page.get_by_role("button", name="Start the cohort").click()
        expect(seen.page.get_by_role("heading", name="Zipped")).to_be_visible()
        expect(seen.page.get_by_role("link", name="cleo")).to_be_visible()
        assert len(uploads) == 1
    [cohort] = [one for one in api.services.cohorts.list(DEFAULT_WORKSPACE).items if one.name == "Zipped"]
    assert [one.code for one in cohort.refused] == ["stl.not_stl"]
    [mesh] = [one for one in api.client.get("/v1/meshes").json()["meshes"] if one["name"] == "cleo"]
    assert mesh["unit"] == "cm"
