"""Every code block of the documentation does what it says, against a real server and with the real client."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from integument import Client

from core.schema.processes import PROCESSES
from tests.docs.blocks import ALL, PAGES, RUNNABLE, SHOWN, Block, pages_with
from tests.docs.read_only import complaints
from tests.docs.workshop import Workshop, as_inputs

REQUESTS = [block for block in ALL if block.language == "json"]
PROGRAMS = {"jq": "jq", "curl": "curl", "octave-cli": "octave", "unzip": "unzip"}


def place(block: Block) -> str:
    return block.place


def test_every_block_is_of_a_language_that_is_checked() -> None:
    assert [block.place for block in ALL if block.language not in RUNNABLE | SHOWN] == []
    fences = sum(len(re.findall(r"^\s*```", page.read_text(encoding="utf-8"), flags=re.MULTILINE)) // 2 for page in PAGES)
    assert len(ALL) == fences, "a fence that was not read as a block"


def test_programs_of_the_blocks_are_installed() -> None:
    missing = [package for program, package in PROGRAMS.items() if shutil.which(program) is None]
    assert missing == [], f"apt-get install --no-install-recommends {' '.join(missing)} (or `make debian` as root)"


@pytest.mark.parametrize("page", pages_with("run"))
def test_blocks_run(page: str, ball_workshop: Workshop, folder: Path) -> None:
    done = ball_workshop.run_page([block for block in ALL if block.page == page and _is_program(block, "run")], folder)
    assert done.returncode == 0, f"{done.stdout[-3000:]}\n{done.stderr[-3000:]}"


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("page", pages_with("slow"))
def test_blocks_run_on_the_whole_body(page: str, body_workshop: Workshop, folder: Path) -> None:
    done = body_workshop.run_page([block for block in ALL if block.page == page and _is_program(block, "run", "slow")], folder)
    assert done.returncode == 0, f"{done.stdout[-3000:]}\n{done.stderr[-3000:]}"


@pytest.mark.parametrize("block", REQUESTS, ids=place)
def test_requests_are_accepted(block: Block, ball_workshop: Workshop) -> None:
    process = Path(block.page).stem
    assert process in PROCESSES, "a request stands on the page of its process"
    with Client(ball_workshop.url) as client:
        client.dismiss(client.execute(process, as_inputs(block, ball_workshop)))


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("block", [block for block in REQUESTS if not block.is_read_only], ids=place)
def test_requests_are_carried_out(block: Block, body_workshop: Workshop) -> None:
    with Client(body_workshop.url) as client:
        job = client.wait(client.execute(Path(block.page).stem, as_inputs(block, body_workshop)))
    assert job.status == "successful"


@pytest.mark.parametrize("block", [block for block in ALL if block.is_read_only], ids=place)
def test_blocks_that_are_not_run_parse(block: Block) -> None:
    assert complaints(block) == []


def _is_program(block: Block, *hows: str) -> bool:
    return block.how in hows and block.language in RUNNABLE - {"json"}
