import io
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.network.reading import load_network

EVIDENCE: list[dict[str, Any]] = [
    {"action": "cat-vision", "label": "mug"},
    {"action": "mat-vision", "likelihood": dict.fromkeys(load_network("household").categorical[1].states, 0.5)},
    {"action": "mat-sound", "posterior": {"glass": 0.7, "ceramic": 0.3}, "temperature": 2},
    {"action": "weighing", "value": 0.118, "unit": "kg"},
    {"action": "squeezing", "value": 42.0, "unit": "kPa", "sd": 5},
    {"action": "squeezing", "above": 95, "unit": "kPa"},
    {"action": "squeezing", "failed": True},
]
EvidenceFile = Callable[[list[dict[str, Any]]], Path]


def answer(run: Any, path: object, *options: str) -> Any:
    ran = run("infer", path, "--json", *options)
    assert ran.code == 0, ran.err
    return json.loads(ran.out, parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))


def test_json_holds_every_property_and_action(run: Any, evidence_file: EvidenceFile) -> None:
    """Properties, actions and objectives stand in the network's order, each with every field."""
    network = load_network("household")
    found = answer(run, evidence_file(EVIDENCE))
    assert list(found) == ["properties", "expected_gain_bits", "log_evidence_bits", "evidence"]
    assert list(found["properties"]) == list(network.properties)
    for name, entry in found["properties"].items():
        fields = ["unit", "mean", "sd", "quantiles", "entropy_bits"]
        assert list(entry) == (["probabilities", "entropy_bits"] if name in ("category", "material") else fields)
    assert list(found["properties"]["mass"]["quantiles"]) == ["0.05", "0.5", "0.95"]
    assert list(found["expected_gain_bits"]) == list(network.actions)
    for gains in found["expected_gain_bits"].values():
        assert list(gains) == [*network.properties, "everything"]
    assert [entry["action"] for entry in found["evidence"]] == [item["action"] for item in EVIDENCE]
    assert [entry["surprise"] is None for entry in found["evidence"]] == [
        False, True, True, False, False, False, True,
    ]  # fmt: skip


def test_a_label_is_bayes_rule(run: Any, evidence_file: EvidenceFile) -> None:
    """After one label the belief, the surprise and the log evidence are what Bayes' rule gives by hand."""
    network = load_network("household")
    sensor: Any = network.action("cat-vision").sensor
    category = network.categorical[0]
    joint = sensor.table / len(category.states)  # the prior is uniform
    predictive = joint.sum(axis=1)
    row = sensor.outcomes.index("mug")
    found = answer(run, evidence_file(EVIDENCE[:1]))
    expected = dict(zip(category.states, joint[row] / predictive[row], strict=True))
    assert found["properties"]["category"]["probabilities"] == pytest.approx(expected, abs=1e-12)
    assert found["log_evidence_bits"] == pytest.approx(math.log2(predictive[row]), abs=1e-9)
    no_more_probable = predictive[predictive <= predictive[row] + 1e-12].sum()
    assert found["evidence"] == [{"action": "cat-vision", "surprise": pytest.approx(no_more_probable, abs=1e-9)}]


def test_entropies_are_those_of_the_numbers_printed(run: Any, evidence_file: EvidenceFile) -> None:
    """`entropy_bits` of a categorical property is the entropy of its probabilities; all digits are printed."""
    found = answer(run, evidence_file(EVIDENCE[:4]))
    for name in ("category", "material"):
        p = np.array(list(found["properties"][name]["probabilities"].values()))
        assert p.sum() == pytest.approx(1, abs=1e-12)
        assert found["properties"][name]["entropy_bits"] == pytest.approx(-(p * np.log2(p)).sum(), abs=1e-9)


def test_no_evidence_is_the_prior(run: Any, evidence_file: EvidenceFile) -> None:
    """An empty list gives the prior: nothing observed has probability one."""
    found = answer(run, evidence_file([]))
    assert found["log_evidence_bits"] == 0
    assert list(found["properties"]["category"]["probabilities"].values()) == pytest.approx([0.1] * 10)


def test_order_matters_for_surprise_alone(run: Any, evidence_file: EvidenceFile) -> None:
    """Belief and log evidence do not depend on the order of the list; surprise follows it."""
    forward, backward = (answer(run, evidence_file(items)) for items in (EVIDENCE, EVIDENCE[::-1]))
    assert forward["log_evidence_bits"] == pytest.approx(backward["log_evidence_bits"], abs=1e-6)
    for name in ("category", "material"):
        p, q = (found["properties"][name]["probabilities"] for found in (forward, backward))
        assert p == pytest.approx(q, abs=1e-8)
    assert [e["action"] for e in backward["evidence"]] == [e["action"] for e in forward["evidence"]][::-1]


def test_standard_input(run: Any, evidence_file: EvidenceFile, monkeypatch: pytest.MonkeyPatch) -> None:
    """`-` reads the same document from standard input."""
    path = evidence_file(EVIDENCE)
    from_file = answer(run, path)
    monkeypatch.setattr("sys.stdin", io.StringIO(path.read_text(encoding="utf-8")))
    assert answer(run, "-") == from_file


def test_notices_are_on_standard_error(run: Any, evidence_file: EvidenceFile) -> None:
    """A reading beyond saturation is read as above the bound, which standard error tells with the item's place."""
    ran = run("infer", evidence_file([{"action": "squeezing", "value": 420}]), "--json")
    assert "evidence[0]" in ran.err
    assert "above 95" in ran.err
    above = answer(run, evidence_file([{"action": "squeezing", "above": 95}]))
    assert json.loads(ran.out)["properties"] == above["properties"]


def test_tables_for_people(run: Any, evidence_file: EvidenceFile) -> None:
    """Without --json people read the evidence, every property, and every action's gain, without control codes."""
    ran = run("infer", evidence_file(EVIDENCE))
    network = load_network("household")
    assert ran.code == 0
    assert all(name in ran.out for name in (*network.properties, *network.actions, "everything", "log evidence"))
    assert "\x1b" not in ran.out


def test_another_network(run: Any, tmp_path: Path) -> None:
    """Nothing depends on the default network: the second one gives its own properties and actions."""
    network = load_network("pantry")
    path = tmp_path / "none.json"
    path.write_text('{"evidence": []}', encoding="utf-8")
    found = answer(run, path, "--network", "pantry")
    assert list(found["properties"]) == list(network.properties)
    assert list(found["expected_gain_bits"]) == list(network.actions)


@pytest.mark.parametrize(
    ("item", "said"),
    [
        ({"action": "wieghing", "value": 1}, "'weighing'"),
        ({"action": "cat-vision", "label": "mugg"}, "'mug'"),
        ({"action": "weighing", "value": 118, "unit": "kPa"}, "kPa"),
        ({"action": "weighing", "value": 118, "unit": "quux"}, "quux"),
        ({"action": "weighing", "value": 118, "sd": -1}, "sd"),
        ({"action": "weighing", "value": "118"}, "expected a number"),
        ({"action": "weighing", "label": "mug"}, "weighing"),
        ({"action": "weighing"}, "outcome"),
        ({"value": 118}, "action"),
        ({"action": "mat-vision", "likelihood": {"glass": 1}}, "ceramic"),
        ({"action": "mat-vision", "posterior": {"glass": -1}}, "-1"),
        ("weighing", "expected an object"),
        ([], "expected an object"),
        (None, "expected an object"),
    ],
)
def test_a_wrong_item_is_named(run: Any, evidence_file: EvidenceFile, item: Any, said: str) -> None:
    """Bad evidence is refused in one sentence with the item's place and what would be right."""
    refused = run("infer", evidence_file([EVIDENCE[0], item]), "--json").refused
    assert "evidence[1]: " in refused
    assert said in refused


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('{"evidence": [', "line 1"),
        ("", "line 1"),
        ("[]", '{"evidence": [...]}'),
        ('{"evidence": {}}', '{"evidence": [...]}'),
        ('{"evidence": [], "evidenze": []}', "'evidenze'"),
        ('{"evidence": [], "evidence": []}', "twice"),
        ('{"evidence": [{"action": "weighing", "value": NaN}]}', "NaN"),
        ('{"evidence": [{"action": "weighing", "value": -Infinity}]}', "-Infinity"),
        ('{"evidence": [{"action": "weighing", "value": 1e999}]}', "evidence[0]"),
        ("[" * 100_000, "nested"),
    ],
)
def test_a_wrong_document_is_refused(run: Any, tmp_path: Path, text: str, said: str) -> None:
    """Text that is no evidence, or no JSON, is refused in one sentence that names the file."""
    path = tmp_path / "evidence.json"
    path.write_text(text, encoding="utf-8")
    refused = run("infer", path).refused
    assert "evidence.json" in refused
    assert said in refused


def test_what_cannot_be_read_is_refused(run: Any, tmp_path: Path) -> None:
    """A missing file, a folder and bytes that are no text are refused with their name."""
    assert "none.json" in run("infer", tmp_path / "none.json").refused
    assert tmp_path.name in run("infer", tmp_path).refused
    (tmp_path / "bytes.json").write_bytes(b"\xff\xfe\x00")
    assert "UTF-8" in run("infer", tmp_path / "bytes.json").refused


def test_unknown_network_and_engine_list_the_choices(run: Any, evidence_file: EvidenceFile) -> None:
    """An unknown network or engine is refused with those there are."""
    path = evidence_file([])
    assert "'household'" in run("infer", path, "--network", "hausehold").refused
    assert "'exact'" in run("infer", path, "--engine", "magic").refused


def test_impossible_evidence_names_the_observation(run: Any, tmp_path: Path) -> None:
    """Evidence of probability zero is an error that names the item, not a belief of NaN."""
    network = tmp_path / "door.toml"
    network.write_text(
        """
format = "palpate-network/1"
[properties.door]
states = ["open", "shut"]
[actions.look]
cost_s = 1
[actions.look.sensor]
property = "door"
kind = "confusion"
[actions.look.sensor.given]
open = [1, 0]
shut = [0, 1]
""",
        encoding="utf-8",
    )
    path = tmp_path / "evidence.json"
    items = [{"action": "look", "label": "open"}, {"action": "look", "label": "shut"}]
    path.write_text(json.dumps({"evidence": items}), encoding="utf-8")
    refused = run("infer", path, "--network", network).refused
    assert "evidence[1]: " in refused
    assert "probability zero" in refused


def test_practically_impossible_evidence_is_told(run: Any, evidence_file: EvidenceFile) -> None:
    """Evidence whose surprise is practically zero has a note that says what to suspect; other evidence has none."""
    items = [{"action": "weighing", "value": 100, "unit": "g"}, {"action": "weighing", "value": -500, "unit": "g"}]
    ran = run("infer", evidence_file(items))
    assert ran.code == 0
    assert ran.err == (
        "note: evidence[1]: practically impossible under this network: "
        "wrong sensor, wrong unit, or an object it does not know\n"
    )
