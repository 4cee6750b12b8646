"""What a job was asked for can be asked for again."""

from __future__ import annotations

from tests.api.live import Live


def test_inputs_come_back_as_sent_with_their_defaults_and_can_be_sent_again(api: Live, mesh_href: str) -> None:
    sent = {"meshes": [{"href": f"{api.url}{mesh_href}"}]}
    job = api.execute("validate", sent).json()["jobID"]
    asked = api.client.get(f"/v1/jobs/{job}/inputs").json()
    assert asked == {"processID": "validate", "inputs": {"meshes": [{"href": mesh_href}], "min_gap_mm": 0.0}}
    again = api.execute(asked["processID"], asked["inputs"])
    assert again.status_code == 201
    assert api.client.get(f"/v1/jobs/{again.json()['jobID']}/inputs").json() == asked


def test_a_null_that_is_not_the_default_is_kept(api: Live, mesh_href: str) -> None:
    sent = {"mesh": {"href": mesh_href}, "radius_edge": None}
    job = api.execute("tetrahedralize", sent).json()["jobID"]
    asked = api.client.get(f"/v1/jobs/{job}/inputs").json()["inputs"]
    assert asked == {
        "mesh": {"href": mesh_href},
        "mesher": "auto",
        "radius_edge": None,
        "conductivities_s_per_m": {},
        "max_volume_mm3": {},
        "min_gap_mm": 0.05,
    }
