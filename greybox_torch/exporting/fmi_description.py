"""The model descriptions of FMI 2.0 and 3.0.

Source: Modelica Association, Functional Mock-up Interface for Model Exchange and Co-Simulation, 2.0.4; Functional Mock-up Interface, 3.0.1.
"""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from greybox_torch import __version__
from greybox_torch.exporting.exported import ExportedModel
from greybox_torch.exporting.fmi_variables import FmiVariable

_TOOL = f"greybox_torch {__version__}"
_CAUSALITY = {"input": "input", "rate": "input", "output": "output", "state": "local"}
_STATE_2 = ("canGetAndSetFMUstate", "canSerializeFMUstate")
_CAUSALITY |= {"parameter": "parameter", "switch": "parameter"}


def description_2(model: ExportedModel, variables: Sequence[FmiVariable], token: str, sources: Sequence[str]) -> bytes:
    """modelDescription.xml of FMI 2.0; ``sources`` are the files to be compiled."""
    root = Element("fmiModelDescription", _head(model, "2.0", guid=token))
    kind = SubElement(root, "CoSimulation", _cosimulation(model, "canInterpolateInputs", *_STATE_2))
    files = SubElement(kind, "SourceFiles")
    for name in sources:
        SubElement(files, "File", name=name)
    _units(root, variables)
    SubElement(root, "DefaultExperiment", startTime="0.0", stepSize=repr(model.step))
    listed = SubElement(root, "ModelVariables")
    for v in variables:
        one = SubElement(listed, "ScalarVariable", _about(v))
        values = _values(v)
        SubElement(one, "Boolean" if v.kind == "switch" else "Real", values)
    structure = SubElement(root, "ModelStructure")
    for part in ("Outputs", "InitialUnknowns"):
        unknowns = SubElement(structure, part)
        for k, v in enumerate(variables, 1):
            if v.kind == "output":
                SubElement(unknowns, "Unknown", index=str(k))
    return _text(root)


def description_3(model: ExportedModel, variables: Sequence[FmiVariable], token: str) -> bytes:
    """modelDescription.xml of FMI 3.0."""
    root = Element("fmiModelDescription", _head(model, "3.0", instantiationToken=token))
    SubElement(root, "CoSimulation", _cosimulation(model, "canGetAndSetFMUState", "canSerializeFMUState"))
    _units(root, variables)
    SubElement(root, "DefaultExperiment", startTime="0.0", stepSize=repr(model.step))
    listed = SubElement(root, "ModelVariables")
    for v in variables:
        SubElement(listed, "Boolean" if v.kind == "switch" else "Float64", {**_about(v), **_values(v)})
    time = "time" if all(v.name != "time" for v in variables) else "simulation_time"
    clock = {
        "name": time,
        "valueReference": str(len(variables)),
        "causality": "independent",
        "variability": "continuous",
    }
    SubElement(listed, "Float64", {**clock, "description": "simulation time in seconds"})
    structure = SubElement(root, "ModelStructure")
    for part in ("Output", "InitialUnknown"):
        for v in variables:
            if v.kind == "output":
                SubElement(structure, part, valueReference=str(v.reference))
    return _text(root)


def build_description(model: ExportedModel, sources: Sequence[str]) -> bytes:
    """buildDescription.xml of FMI 3.0: how the sources are compiled."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=model.identifier)
    files = SubElement(configuration, "SourceFileSet", language="C99")
    for name in sources:
        SubElement(files, "SourceFile", name=name)
    return _text(root)


def _head(model: ExportedModel, edition: str, **token: str) -> dict[str, str]:
    head = {"fmiVersion": edition, "modelName": model.title, **token, "generationTool": _TOOL}
    return {
        **head,
        **({"description": model.description} if model.description else {}),
        "variableNamingConvention": "flat",
    }


def _cosimulation(model: ExportedModel, *abilities: str) -> dict[str, str]:
    can = dict.fromkeys(("canHandleVariableCommunicationStepSize", *abilities), "true")
    return {"modelIdentifier": model.identifier, **can}


def _units(root: Element, variables: Sequence[FmiVariable]) -> None:
    units = dict.fromkeys(v.of.unit for v in variables if v.of.unit and v.kind != "switch")
    if units:
        listed = SubElement(root, "UnitDefinitions")
        for unit in units:
            SubElement(listed, "Unit", name=unit)


def _about(v: FmiVariable) -> dict[str, str]:
    told = {"name": v.name, "valueReference": str(v.reference)}
    if v.kind == "switch":  # true or false here, and no number
        told["description"] = f"whether {v.name.removesuffix('.active')} acts"
    elif v.of.description:
        told["description"] = v.of.description
    told["causality"] = _CAUSALITY[v.kind]
    told["variability"] = "tunable" if v.kind in ("parameter", "switch") else "continuous"
    initial = {"output": "calculated", "state": "exact", "parameter": "exact", "switch": "exact"}
    return {**told, **({"initial": initial[v.kind]} if v.kind in initial else {})}


def _values(v: FmiVariable) -> dict[str, str]:
    if v.kind == "switch":
        return {"start": "true" if v.of.value else "false"}
    told = {"unit": v.of.unit} if v.of.unit else {}
    if v.kind == "parameter":
        told |= {
            key: repr(bound) for key, bound in (("min", v.of.lower), ("max", v.of.upper)) if abs(bound) != float("inf")
        }
    return told if v.kind == "output" else {**told, "start": repr(v.of.value)}


def _text(root: Element) -> bytes:
    indent(root)
    return tostring(root, encoding="UTF-8", xml_declaration=True) + b"\n"
