"""The manual's pages that come from the code: every parameter, every preset with its sources, all that a check finds."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

from nested_dielectric.checking.finding import Action
from nested_dielectric.checking.kinds import KINDS, Severity
from nested_dielectric.model import distributions
from nested_dielectric.model.parameter import Limit, Parameter
from nested_dielectric.model.parameters import PARAMETERS
from nested_dielectric.model.presets import Preset, all_presets

FOLDER = Path(__file__).resolve().parent.parent

PARAMETERS_INTRODUCTION = """\
# Every parameter

Made from the code by `make docs`. The five that artists change first are on the panel *Medium*; all others stand under
*Advanced*, by the headings below. A link or a script may give a socket any number: the nearest within the limits counts
([Nodes](nodes.md)).

*Keyword* is the name in [Python](python.md) and in preset files. In Python, choices are the upper-case words. Values are
those of a new node; [presets](presets.md) bring their own.

*Rendered by* says which of a material's two bodies has it: the shader in OSL, Cycles' own nodes, or both
([Render With](speed.md#render-with)).
"""

SPECTRUM_NOTE = """\
These four are no sockets but settings of the material (*Spectrum...* on the panel). `spectral_distribution` is {words}, \
the name of a CIE illuminant or the path of a CSV file of wavelength (nm) and power.
"""

PRESETS_INTRODUCTION = """\
# Presets

Made from the files in `presets/` by `make docs`. *Depth* is the thickness at which people know the thing, and *Colour* is
what white light is after it; when a preset is assigned, the depth becomes the object's own thickness
([Colour](colour.md)). The numbers win by priority: lowest first.

![All presets](pictures/presets.jpg)

A preset is a readable file: TOML with a name, a group, tags, a description, the source of its numbers and a table
`[parameters]` of [keywords](parameters.md). Your own are saved from the panel ([Five-minute start](start.md)).
"""


FINDINGS_INTRODUCTION = """\
# What a check finds

Made from the code by `make docs`. *Prepare Scene* checks, too; `nd.check(scene)` and the [command](command-line.md) `check`
change nothing. Each finding names the object, the place, what the picture would show and the remedy, and many have a button
that mends them. *Kind* is its name in JSON.
"""

FINDINGS_END = """\
## Fixes

Each is one step to undo. *Fix All* does those that change nothing an artist may have meant, checks again, and says what it
left.

{actions}

## As JSON

`check --json` writes one object. Keys stay; new ones may come. `schema` is counted on when one goes or means another thing.

| Key | What it is |
| --- | --- |
| `schema`, `file`, `blender` | version of this form (1), the file, the version of Blender |
| `version`, `error` | the extension's version; why the command failed, in one line, or null |
| `saved` | the file that `--fix` wrote, or null |
| `scenes` | for each scene: `scene`, its name; `changes`, what `--fix` changed, in sentences; `findings` |
| `kind`, `severity` | of a finding: as above; `wrong picture`, `slow` or `note` |
| `objects` | names of all that is concerned: what the finding is about first |
| `text`, `shows`, `remedy` | what is wrong, after the name; what the picture would show; what to do |
| `faces`, `point` | polygons of the evaluated mesh, and a point in the world (scene units), or null |
| `fix` | null, or `action`, `names` of what it changes, `value`, `path` and whether it is `safe` |
"""


def _table(rows: list[tuple[str, ...]]) -> str:
    head, *body = rows
    lines = [head, ("---",) * len(head), *body]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines) + "\n"


def parameters_page() -> str:
    """Return the page of all parameters, under the headings of the panel."""
    parts = [PARAMETERS_INTRODUCTION]
    for panel in dict.fromkeys(parameter.panel for parameter in PARAMETERS):
        members = [parameter for parameter in PARAMETERS if parameter.panel == panel]
        rows = [
            ("Parameter", "Keyword", "Default", "Values", "What it does", "Rendered by"),
            *map(_parameter_row, members),
        ]
        parts += [f"## {panel}\n", _table(rows), *_choices(members)]
    words = ", ".join(f"`{choice.keyword}` ({choice.description})" for choice in distributions.DISTRIBUTIONS)
    return "\n".join((*parts, SPECTRUM_NOTE.format(words=words)))


def _parameter_row(parameter: Parameter) -> tuple[str, ...]:
    label = parameter.label
    name = f"**{parameter.name}**" + (f" (*{label}* on the panel)" if label else "")
    cells = _default(parameter), _values(parameter), parameter.description, _bodies(parameter.limit)
    return name, f"`{parameter.keyword}`", *cells


def _bodies(limit: Limit | None) -> str:
    """Which bodies of the material have a parameter, and what Cycles' own nodes do otherwise."""
    if limit is None:
        return "Both"
    return f"{'OSL alone' if limit.alone else 'Both'}; Cycles' own nodes {limit.text}"


def _default(parameter: Parameter) -> str:
    if parameter.kind in ("COLOR", "VECTOR"):
        return ", ".join(f"{component:g}" for component in parameter.default)
    return {"SHADER": "none", "BOOL": "on" if parameter.default else "off"}.get(parameter.kind, str(parameter.default))


def _values(parameter: Parameter) -> str:
    if parameter.minimum is not None:
        return f"{parameter.minimum:g} to {parameter.maximum:g}"
    if parameter.kind == "BOOL":
        return "on, off"
    return ", ".join(f"`{choice.keyword}`" for choice in parameter.choices)


def _choices(members: list[Parameter]) -> list[str]:
    """What the words of menus mean, each list of words once."""
    named: dict[tuple, list[str]] = {}
    for parameter in members:
        if parameter.choices:
            named.setdefault(parameter.choices, []).append(parameter.name)
    return [
        f"*{', '.join(names)}*:\n\n"
        + "".join(f"- `{choice.keyword}`, {choice.name}: {choice.description}\n" for choice in choices)
        for choices, names in named.items()
    ]


def presets_page() -> str:
    """Return the page of all presets by groups, and the sources of their numbers."""
    parts = [PRESETS_INTRODUCTION]
    for group, presets in groupby(all_presets(), key=lambda preset: preset.group):
        members = list(presets)
        head = ("Preset", "In Python", "IOR", "Colour at depth", "Priority", "What it is")
        sources = "".join(f"- **{preset.name}**: {preset.source}\n" for preset in members)
        parts += [f"## {group}\n", _table([head, *map(_preset_row, members)]), f"Sources:\n\n{sources}"]
    return "\n".join(parts)


def _preset_row(preset: Preset) -> tuple[str, ...]:
    values = preset.parameters
    ior = f"{values['ior']:.4g}" if "ior" in values else ""
    priority = str(values.get("priority", 0))
    return f"**{preset.name}**", f"`{preset.key}`", ior, _colour(preset), priority, preset.description


def _colour(preset: Preset) -> str:
    colour = preset.parameters.get("transmittance", (1.0, 1.0, 1.0))
    if tuple(colour) == (1.0, 1.0, 1.0):
        return "clear"
    depth = preset.parameters.get("transmittance_depth", 1.0)
    return f"{', '.join(f'{component:.2g}' for component in colour)} at {depth * 100:g} cm"


def findings_page() -> str:
    """Return the page of all kinds of findings, by severity, and of what mends them."""
    parts = [FINDINGS_INTRODUCTION]
    for severity in Severity:
        rows = [(f"`{kind.key}`", kind.shows) for kind in KINDS.values() if kind.severity == severity]
        parts += [f"## {severity.value.capitalize()}\n", _table([("Kind", "What the picture shows"), *rows])]
    actions = "".join(f"- **{action.value}** (`{action.name}`)\n" for action in Action)
    return "\n".join((*parts, FINDINGS_END.format(actions=actions.rstrip())))


PAGES = {"parameters.md": parameters_page, "presets.md": presets_page, "findings.md": findings_page}


def make() -> None:
    """Write the pages."""
    for name, page in PAGES.items():
        (FOLDER / name).write_text(page(), encoding="utf-8")
