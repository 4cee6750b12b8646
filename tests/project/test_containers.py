"""docker-compose.yml and Dockerfile, checked with what needs no Docker engine; tests/acceptance runs their commands."""

import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import yaml

from server.embedded import API_COMMAND, WORKER_COMMAND
from server.valkey import valkey_program
from store.settings import PREFIX, Settings
from tests.project.compose import SECRETS, UnsetVariableError, read_compose
from tests.project.sources import ROOT

OURS = ("migrate", "api", "worker")
PROFILES = {
    None: {"migrate", "api", "worker", "valkey", "postgres"},
    "s3": {"objects", "objects-bucket"},
    "observability": {"prometheus", "grafana"},
}
ONCE = {"migrate", "objects-bucket"}
FULL_VERSION = re.compile(r"[a-z0-9./-]+:v?\d+\.\d+(\.\d+)?(-[a-z0-9]+)*")
TWO_NUMBERS = ("postgres", "chrislusf/seaweedfs")  # these name a full version so
DOCKERFILE = ROOT / "Dockerfile"


@pytest.fixture(scope="module")
def services() -> dict[str, Any]:
    found: dict[str, Any] = read_compose(SECRETS)["services"]
    return found


def test_compose_file_is_valid_and_complete(services: dict[str, Any]) -> None:
    by_profile: dict[str | None, set[str]] = {}
    for name, service in services.items():
        (profile,) = service.get("profiles", [None])
        by_profile.setdefault(profile, set()).add(name)
    assert by_profile == PROFILES
    for service in services.values():
        assert set(service.get("depends_on", {})) <= PROFILES[service.get("profiles", [None])[0]] | PROFILES[None]


def test_images_have_full_versions(services: dict[str, Any]) -> None:
    images = {service["image"] for name, service in services.items() if name not in OURS}
    images |= {line.partition("=")[2] for line in instructions("ARG")}
    for image in images:
        match = FULL_VERSION.fullmatch(image)
        assert match is not None, image
        assert match[1] is not None or image.startswith(TWO_NUMBERS), image


def test_secrets_of_profiles_are_files_without_defaults(services: dict[str, Any]) -> None:
    secrets = read_compose(SECRETS)["secrets"]
    assert all(set(secret) == {"environment"} for secret in secrets.values())
    assert {name for service in services.values() for name in service.get("secrets", [])} == set(secrets)


def test_the_object_store_knows_its_options(services: dict[str, Any]) -> None:
    weed = str(Path(sys.executable).with_name("weed"))
    known = subprocess.run([weed, "help", "server"], capture_output=True, text=True, timeout=60)
    options = {option.partition("=")[0] for option in services["objects"]["command"][1:]}
    told = known.stdout + known.stderr
    assert [option for option in options if not re.search(rf"^\s*{re.escape(option)}\b", told, re.MULTILINE)] == []


@pytest.mark.parametrize("missing", SECRETS)
def test_no_secret_has_a_default(missing: str) -> None:
    with pytest.raises(UnsetVariableError, match=missing):
        read_compose({name: value for name, value in SECRETS.items() if name != missing})


@pytest.mark.parametrize("name", sorted(name for names in PROFILES.values() for name in names))
def test_every_service_is_hardened(services: dict[str, Any], name: str) -> None:
    service = services[name]
    assert re.fullmatch(r"[1-9]\d*:[1-9]\d*", service["user"]), "a number, so that it holds in any image, and not root"
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert not {"privileged", "cap_add", "network_mode", "pid", "devices"} & set(service)
    assert "healthcheck" in service or name in ONCE
    assert "mem_limit" in service
    assert "pids_limit" in service


def test_only_the_api_is_reachable_and_only_from_this_machine(services: dict[str, Any]) -> None:
    assert {name: service["ports"] for name, service in services.items() if "ports" in service} == {
        "api": ["127.0.0.1:8000:8000"],
        "grafana": ["127.0.0.1:3000:3000"],
    }
    assert {name for name, service in services.items() if "outside" in service["networks"]} == {"api", "grafana"}
    assert read_compose(SECRETS)["networks"]["inside"] == {"internal": True}


def test_commands_are_those_the_embedded_server_and_the_tests_run(services: dict[str, Any]) -> None:
    assert services["api"]["command"] == ["python", *API_COMMAND]
    assert services["worker"]["command"] == ["python", *WORKER_COMMAND]
    assert services["migrate"]["command"][:2] == ["python", "-m"]
    for name in OURS:
        assert find_spec(services[name]["command"][2]) is not None


def test_valkey_keeps_the_queue_as_the_embedded_one_does(services: dict[str, Any]) -> None:
    command = services["valkey"]["command"]
    lab = dict(zip(command[1::2], command[2::2], strict=True))
    program = valkey_program(Path("/data"), Path("/data/valkey.sock")).command
    embedded = dict(zip(program[1::2], program[2::2], strict=True))
    for option in ("--appendonly", "--appendfsync", "--maxmemory-policy", "--save"):
        assert lab[option] == embedded[option]
    assert lab["--requirepass"] == SECRETS["VALKEY_PASSWORD"]


@pytest.mark.parametrize("name", OURS)
def test_settings_are_accepted(services: dict[str, Any], name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for key, value in services[name]["environment"].items():
        assert key.startswith(PREFIX)
        monkeypatch.setenv(key, value)
    settings = Settings()
    assert settings.database_url == "postgresql://integument:sesame1@postgres:5432/integument"
    assert settings.broker_url == "redis://:sesame2@valkey:6379/0"
    assert str(settings.data_dir) == "/data"
    assert (settings.require_keys == "true") is (name == "api")


def test_the_api_answers_to_the_name_prometheus_calls_it(services: dict[str, Any]) -> None:
    config = yaml.safe_load((ROOT / "deploy" / "prometheus" / "prometheus.yml").read_text())
    ((target,),) = [entry["targets"] for scrape in config["scrape_configs"] for entry in scrape["static_configs"]]
    name, _, port = target.partition(":")
    environment = services["api"]["environment"]
    assert name in environment["INTEGUMENT_ALLOWED_HOSTS"].split(",")
    assert (name, port) == ("api", environment["INTEGUMENT_PORT"])


def test_other_settings_reach_our_programs_by_a_file_that_need_not_be(services: dict[str, Any]) -> None:
    for name in OURS:
        assert services[name]["env_file"] == [{"path": "settings.env", "required": False}]


def test_files_with_secrets_are_not_committed() -> None:
    names = [".env", "settings.env", "compose.override.yaml"]
    ignored = subprocess.run(["git", "check-ignore", *names], cwd=ROOT, capture_output=True, text=True)
    assert ignored.stdout.split() == names


def test_nothing_starts_before_what_it_needs(services: dict[str, Any]) -> None:
    for name in ("api", "worker"):
        assert services[name]["depends_on"] == {
            "migrate": {"condition": "service_completed_successfully"},
            "postgres": {"condition": "service_healthy"},
            "valkey": {"condition": "service_healthy"},
        }
    assert services["migrate"]["depends_on"] == {"postgres": {"condition": "service_healthy"}}
    assert services["migrate"]["restart"] == "no"


def test_what_must_survive_is_on_named_volumes(services: dict[str, Any]) -> None:
    mounted = {volume.partition(":")[0] for service in services.values() for volume in service.get("volumes", [])}
    files = {source for source in mounted if source.startswith("./")}
    assert all((ROOT / source).is_dir() for source in files)
    assert (
        mounted - files
        == set(read_compose(SECRETS)["volumes"])
        == {"data", "postgres", "valkey", "objects", "prometheus", "grafana"}
    )
    assert services["api"]["volumes"] == services["worker"]["volumes"] == ["data:/data"]


def test_containers_get_the_time_their_parts_take_to_stop(services: dict[str, Any]) -> None:
    def seconds(service: str) -> float:
        return float(services[service]["stop_grace_period"].removesuffix("s"))

    assert seconds("worker") > Settings().drain_s
    assert seconds("api") >= 20


def test_dockerfile_passes_the_linter() -> None:
    command = [str(Path(sys.executable).with_name("hadolint")), "--failure-threshold", "style", str(DOCKERFILE)]
    outcome = subprocess.run(command, capture_output=True, text=True)
    assert outcome.returncode == 0, outcome.stdout


def instructions(name: str, stage: str = "") -> list[str]:
    """The arguments of every such instruction of the Dockerfile or of one stage of it, continued lines joined."""
    text = re.sub(r"\\\n\s*", " ", DOCKERFILE.read_text(encoding="utf-8"))
    if stage:
        (text,) = (
            part for part in re.split(r"^(?=FROM )", text, flags=re.MULTILINE) if part.partition("\n")[0].endswith(f" AS {stage}")
        )
    return re.findall(rf"^{name} (.*)$", text, flags=re.MULTILINE)


def test_image_holds_every_package_the_wheel_does() -> None:
    with (ROOT / "pyproject.toml").open("rb") as file:
        packages = tomllib.load(file)["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"]
    copied = [shlex.split(line) for line in instructions("COPY")]
    assert set(packages) <= {words[0] for words in copied}
    ignored = (ROOT / ".dockerignore").read_text().splitlines()
    for words in copied:
        if not words[0].startswith("--"):
            assert all((ROOT / source).exists() for source in words[:-1])
            assert all(f"!{source.partition('/')[0]}" in ignored for source in words[:-1])


def test_image_is_built_from_the_lock_file_without_tools_for_development() -> None:
    installs = [line for line in instructions("RUN") if "uv sync" in line]
    assert all("--frozen" in line and "--no-default-groups" in line for line in installs)
    assert [line for line in installs if "--group" in line] == [
        line for line in instructions("RUN", "handbook") if "--group docs" in line
    ]
    assert len(instructions("RUN", "dependencies")) == 1


def test_our_own_code_is_never_taken_from_a_cache() -> None:
    """uv keeps what it built of a folder by the folder's pyproject.toml: a second build had the first one's code."""
    (install,) = instructions("RUN", "build")
    assert "--no-cache" in install
    assert "--mount" not in install
    others = [line for line in instructions("RUN") if "uv sync" in line and line != install]
    assert all("--no-install-workspace" in line for line in others)


def test_handbook_needs_nothing_its_stage_does_not_copy(tmp_path: Path) -> None:
    """A page that links to another file of the tree would be told of as a broken link, and the image would not be built."""
    tree, there, here = tmp_path / "tree", tmp_path / "there", tmp_path / "here"
    for line in instructions("COPY", "handbook"):
        *sources, target = shlex.split(line)
        for source in sources:
            if (ROOT / source).is_dir():
                shutil.copytree(ROOT / source, tree / target, ignore=shutil.ignore_patterns("__pycache__", "viewer"))
            else:
                (tree / target).mkdir(parents=True, exist_ok=True)
                shutil.copy(ROOT / source, tree / target)
    for root, folder in ((tree, there), (ROOT, here)):
        code = f"from pathlib import Path; from scripts.handbook.stage import stage; stage(Path({str(folder)!r}))"
        subprocess.run([sys.executable, "-c", code], cwd=root, check=True)
    pages = sorted(path.relative_to(here) for path in here.rglob("*") if path.is_file())
    assert [page for page in pages if (here / page).read_bytes() != (there / page).read_bytes()] == []
    assert pages == sorted(path.relative_to(there) for path in there.rglob("*") if path.is_file())


def test_image_runs_as_the_user_of_the_compose_file(services: dict[str, Any]) -> None:
    assert instructions("USER") == [services["api"]["user"]]
    assert shlex.split(instructions("CMD")[0].strip("[]").replace(",", " ")) == services["api"]["command"]
