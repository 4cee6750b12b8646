"""deploy/kubernetes as `kubectl kustomize` renders it: what Kubernetes and KEDA take, and what our programs need."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
import yaml
from cloudcoil.models.keda import v1alpha1 as keda

from api.__main__ import GRACE_S
from server.embedded import API_COMMAND, WORKER_COMMAND
from store.settings import PREFIX, Settings
from tests.project.sources import ROOT
from tests.project.test_dashboards import told_metrics

FOLDER = ROOT / "deploy" / "kubernetes"
KUBERNETES = ("1.30.0", "1.37.0")  # oldest and newest that the manifests are held to
Manifest = dict[str, Any]


@pytest.fixture(scope="module")
def manifests(tmp_path_factory: pytest.TempPathFactory) -> list[Manifest]:
    """The overlay with the secrets of its examples."""
    folder = tmp_path_factory.mktemp("kubernetes") / "kubernetes"
    shutil.copytree(FOLDER, folder)
    lab = folder / "overlays" / "lab"
    for example in lab.glob("*.env.example"):
        example.rename(example.with_suffix(""))
    kubectl = str(Path(sys.executable).with_name("kubectl"))
    done = subprocess.run([kubectl, "kustomize", str(lab)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return list(yaml.safe_load_all(done.stdout))


def named(manifests: list[Manifest], kind: str, name: str) -> Manifest:
    (found,) = [one for one in manifests if one["kind"] == kind and one["metadata"]["name"].startswith(name)]
    return found


def pod(manifests: list[Manifest], kind: str, name: str) -> Manifest:
    spec: Manifest = named(manifests, kind, name)["spec"]["template"]["spec"]
    return spec


def pods(manifests: list[Manifest]) -> list[Manifest]:
    return [one["spec"]["template"]["spec"] for one in manifests if one["kind"] in ("Deployment", "Job")]


def settings_of(manifests: list[Manifest], kind: str, name: str, monkeypatch: pytest.MonkeyPatch) -> Settings:
    """As the container's environment makes them."""
    (container,) = pod(manifests, kind, name)["containers"]
    environment = dict(named(manifests, "ConfigMap", "integument")["data"])
    example = (FOLDER / "overlays" / "lab" / "secrets.env.example").read_text().split()
    environment |= dict(line.split("=", 1) for line in example)
    environment |= {one["name"]: one["value"] for one in container.get("env", [])}
    assert {one[kind]["name"].partition("-")[0] for one in container["envFrom"] for kind in one} == {"integument"}
    for key, value in environment.items():
        assert key.startswith(PREFIX)
        monkeypatch.setenv(key, value)
    return Settings()


@pytest.mark.parametrize("version", KUBERNETES)
def test_kubernetes_takes_every_manifest(manifests: list[Manifest], version: str) -> None:
    kinds = set()
    for manifest in manifests:
        if "keda.sh" not in manifest["apiVersion"]:
            kubernetes_validate.validate(manifest, version, strict=True)
            kinds.add(manifest["kind"])
    assert {"Deployment", "Job", "Service", "PodDisruptionBudget", "NetworkPolicy", "Secret", "ConfigMap"} <= kinds


def test_the_validator_is_no_rubber_stamp(manifests: list[Manifest]) -> None:
    broken = yaml.safe_load(yaml.safe_dump(named(manifests, "Deployment", "integument-api")))
    broken["spec"]["template"]["spec"]["containers"][0]["readinessprobe"] = {}
    with pytest.raises(kubernetes_validate.ValidationError):
        kubernetes_validate.validate(broken, KUBERNETES[1], strict=True)


@pytest.mark.parametrize("kind", [keda.ScaledObject, keda.TriggerAuthentication], ids=lambda kind: kind.__name__)
def test_keda_takes_its_manifests_and_knows_every_field(manifests: list[Manifest], kind: Any) -> None:
    manifest = named(manifests, kind.__name__, "integument")
    known = kind.model_validate(manifest).model_dump(by_alias=True, exclude_unset=True, mode="json")
    assert known["spec"] == manifest["spec"], "a field its schema does not have is dropped"


def test_it_scales_by_a_metric_that_is_told_at_an_address_that_is_served(
    manifests: list[Manifest], monkeypatch: pytest.MonkeyPatch
) -> None:
    spec = named(manifests, "ScaledObject", "integument-worker")["spec"]
    (trigger,) = spec["triggers"]
    metadata = trigger["metadata"]
    assert metadata["valueLocation"] in told_metrics()
    assert told_metrics()[metadata["valueLocation"]] == frozenset(), "one number, without labels"
    host, _, path = metadata["url"].removeprefix("http://").partition("/")
    service = named(manifests, "Service", "integument-api")
    assert (host, path) == (f"{service['metadata']['name']}.{service['metadata']['namespace']}.svc", "metrics")
    settings = settings_of(manifests, "Deployment", "integument-api", monkeypatch)
    assert host in settings.allowed_hosts
    assert int(metadata["targetValue"]) == settings.worker_concurrency
    assert spec["scaleTargetRef"]["name"] == named(manifests, "Deployment", "integument-worker")["metadata"]["name"]
    assert "replicas" not in named(manifests, "Deployment", "integument-worker")["spec"], "or every apply would undo the scaling"
    assert spec["minReplicaCount"] >= 1
    secret = named(manifests, "TriggerAuthentication", "integument")["spec"]["secretTargetRef"][0]
    assert named(manifests, "Secret", secret["name"])["data"].keys() == {secret["key"]}


def test_pods_are_locked_in(manifests: list[Manifest]) -> None:
    assert len(pods(manifests)) == 3
    for spec in pods(manifests):
        assert spec["automountServiceAccountToken"] is False
        assert spec["securityContext"]["runAsNonRoot"] is True
        assert spec["securityContext"]["runAsUser"] == 10001, "the user of the image"
        assert spec["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}
        for container in spec["containers"]:
            context = container["securityContext"]
            assert context["readOnlyRootFilesystem"] is True
            assert context["allowPrivilegeEscalation"] is False
            assert context["capabilities"] == {"drop": ["ALL"]}
            assert "memory" in container["resources"]["limits"]
            assert {mount["mountPath"] for mount in container["volumeMounts"]} == {"/data", "/tmp"}
            assert ":" in container["image"]
            assert not container["image"].endswith(":latest")


def test_commands_are_those_of_the_other_set_ups(manifests: list[Manifest]) -> None:
    (api,), (worker,), (migrate,) = (
        pod(manifests, kind, name)["containers"]
        for kind, name in (("Deployment", "integument-api"), ("Deployment", "integument-worker"), ("Job", "integument-migrate"))
    )
    assert api["command"] == ["python", *API_COMMAND]
    assert worker["command"] == ["python", *WORKER_COMMAND]
    assert migrate["command"] == ["python", "-m", "store.migrate"]


def test_probes_come_under_a_name_the_api_answers_to(manifests: list[Manifest]) -> None:
    (api,) = pod(manifests, "Deployment", "integument-api")["containers"]
    for probe in ("startupProbe", "livenessProbe", "readinessProbe"):
        get = api[probe]["httpGet"]
        assert get["httpHeaders"] == [{"name": "Host", "value": "localhost"}]
        assert get["path"] in ("/healthz", "/readyz?exclude=workers")
    assert "workers" not in api["livenessProbe"]["httpGet"]["path"]


def test_a_worker_that_is_taken_away_may_end_its_jobs(manifests: list[Manifest], monkeypatch: pytest.MonkeyPatch) -> None:
    settings = settings_of(manifests, "Deployment", "integument-worker", monkeypatch)
    grace_s = pod(manifests, "Deployment", "integument-worker")["terminationGracePeriodSeconds"]
    assert settings.drain_s >= settings.job_wall_s, "the longest job there may be"
    assert grace_s > settings.drain_s + 30
    (worker,) = pod(manifests, "Deployment", "integument-worker")["containers"]
    limit = int(worker["resources"]["limits"]["memory"].removesuffix("Gi")) * 2**30
    assert worker["resources"]["requests"]["memory"] == worker["resources"]["limits"]["memory"], "jobs are admitted by the limit"
    assert limit * 0.8 >= settings.worker_concurrency * settings.job_memory_bytes, "what jobs may take of a host"


def test_an_api_pod_is_asked_until_nobody_sends_it_requests_any_more(manifests: list[Manifest]) -> None:
    spec = pod(manifests, "Deployment", "integument-api")
    (api,) = spec["containers"]
    sleep_s = api["lifecycle"]["preStop"]["sleep"]["seconds"]
    assert sleep_s >= api["readinessProbe"]["periodSeconds"]
    assert spec["terminationGracePeriodSeconds"] >= sleep_s + GRACE_S + 15


def test_every_network_path_is_named(manifests: list[Manifest]) -> None:
    policies = {one["metadata"]["name"]: one["spec"] for one in manifests if one["kind"] == "NetworkPolicy"}
    default = policies["integument-default"]
    assert set(default["policyTypes"]) == {"Ingress", "Egress"}
    assert "ingress" not in default, "nothing comes in"
    ports = {port["port"] for rule in default["egress"] for port in rule["ports"]}
    assert {53, 5432, 6379} <= ports
    (rule,) = policies["integument-api"]["ingress"]
    assert [port["port"] for port in rule["ports"]] == [8000]
    assert rule["from"]


def test_secrets_of_an_overlay_are_not_committed() -> None:
    ignored = subprocess.run(
        ["git", "check-ignore", "deploy/kubernetes/overlays/lab/secrets.env", "deploy/kubernetes/overlays/lab/monitor.env"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert len(ignored.stdout.split()) == 2
