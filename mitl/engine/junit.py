"""junit.xml from the run record: fail is a failure, error an error, inconclusive and skipped are skipped with their reason."""

from __future__ import annotations

import re
from xml.etree import ElementTree as ET

from mitl.engine.record import CaseRecord, RunRecord
from mitl.engine.wording import reason, sentence
from mitl.outcome import Outcome

FILE_NAME = "junit.xml"
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
_TAG = {Outcome.FAIL: "failure", Outcome.ERROR: "error", Outcome.INCONCLUSIVE: "skipped", Outcome.SKIPPED: "skipped"}


def text_of(run: RunRecord) -> str:
    """Gives the text of junit.xml; times are on the rig's clock, the suite's time is real."""
    suite = ET.Element("testsuite", name="mitl", timestamp=_clean(run.started[:19]), time=f"{run.wall_s:.3f}")
    suite.attrib.update(_counts(run))
    properties = ET.SubElement(suite, "properties")
    facts = {
        "rig": run.rig,
        "robot": run.robot,
        "seed": str(run.seed),
        "outcome": run.outcome.value,
        "interrupted": str(run.interrupted).lower(),
    }
    for name, value in [*facts.items(), *(("fault", fault) for fault in run.faults), *run.versions.items()]:
        ET.SubElement(properties, "property", name=_clean(name), value=_clean(value))
    for case in run.cases:
        suite.append(_case(case))
    root = ET.Element("testsuites", name="mitl", time=f"{run.wall_s:.3f}")
    root.attrib.update(_counts(run))
    root.append(suite)
    ET.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _counts(run: RunRecord) -> dict[str, str]:
    tags = [_TAG.get(case.outcome) for case in run.cases]
    return {
        "tests": str(len(tags)),
        "failures": str(tags.count("failure")),
        "errors": str(tags.count("error")),
        "skipped": str(tags.count("skipped")),
    }


def _case(case: CaseRecord) -> ET.Element:
    group, _, name = case.id.rpartition("/")
    element = ET.Element(
        "testcase", classname=_clean(f"mitl.{group}" if group else "mitl"), name=_clean(name), time=f"{case.duration_s:.3f}"
    )
    properties = ET.SubElement(element, "properties")
    for check in case.checks:
        ET.SubElement(properties, "property", name=_clean(f"check: {check.name}"), value=_clean(sentence(check)))
    if case.recording:
        ET.SubElement(properties, "property", name="recording", value=_clean(case.recording))
    tag = _TAG.get(case.outcome)
    if tag:
        why = reason(case)
        headline = f"{case.outcome.value}: {why.splitlines()[0] if why else ''}"
        told = ET.SubElement(element, tag, message=_clean(headline))
        told.text = _clean(why)
        if tag != "skipped":
            told.set("type", case.outcome.value)
    said = "\n".join(f"{message.level}: {message.text}" for message in case.messages)
    if said:
        ET.SubElement(element, "system-out").text = _clean(said)
    return element


def _clean(text: str) -> str:
    """Gives the text without characters that XML cannot carry even escaped."""
    return _NOT_XML.sub("\ufffd", text)
