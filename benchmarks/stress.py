"""Tables and plots of what the stress suite has measured.

Run by ``make stress`` after the tests, which leave their numbers in ``out/stress``; it writes ``results/stress.json``,
``results/stress_*.png`` and the tables in ``README.md``.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "helpers"))

import bpy  # noqa: F401  before mathutils, which the helpers use
import numpy as np
from bench_report import markdown, renew
from matplotlib.figure import Figure
from random_media import SCENES
from significance import STRESS_ASSERTIONS, SUITE, stress_rate

HERE = Path(__file__).resolve().parent
MEASURED = HERE.parent / "out" / "stress"
RESULTS = HERE / "results"

LABELS = {
    "asked": "asking the scene",
    "told": "told where nothing crosses",
    "cut": "cut surfaces",
    "native": "Cycles' own nodes",
    "glass": "Glass on the same bodies",
    "split": "Glass split by hand",
}

STYLES = {"asked": "tab:cyan", "told": "tab:green", "cut": "tab:blue", "native": "tab:purple", "glass": "tab:red"}

FAR = {
    "size": "Size",
    "place": "Distance from the origin",
    "overlap": "Overlap",
    "wall": "Thickness of a wall",
    "shells": "Shells in each other",
}
"""Tables by one number, and what it is."""


def measured() -> dict[str, dict[str, dict]]:
    """Rows by table and name; of a row that was measured twice the last."""
    tables: dict[str, dict[str, dict]] = {}
    for path in sorted(MEASURED.glob("*.jsonl")):
        for line in path.read_text(encoding="utf-8").splitlines():
            row = json.loads(line)
            tables.setdefault(row.pop("table"), {})[row.pop("row")] = row
    return {table: dict(sorted(rows.items(), key=order)) for table, rows in sorted(tables.items())}


def order(item: tuple[str, dict]) -> tuple[float, str]:
    """Rows by number, then by name."""
    try:
        return float(item[0]), item[0]
    except ValueError:
        return 0.0, item[0]


# Tables -------------------------------------------------------------------------------------------------------------


def furnace_table(title: str, rows: Sequence[dict]) -> str:
    """How far random scenes are from white, by way; the highest with its own standard error."""
    header = [title, "scenes", "mean deviation", "lowest", "highest", "brightest part of a pixel", "NaN or infinite"]
    lines = []
    for way, label in LABELS.items():
        chosen = [row["ways"][way] for row in rows if way in row["ways"]]
        if not chosen:
            continue
        means = [numbers["mean"] for numbers in chosen]
        highest = max(chosen, key=lambda numbers: numbers["mean"])
        cells = [str(len(chosen)), small(np.mean(means)), small(min(means)), small(highest["mean"])]
        if highest["error"] > 1e-6:
            cells[-1] += f" ± {highest['error']:.1e}"
        brightest = max(numbers["highest"] for numbers in chosen)
        lines.append([label, *cells, f"{brightest:.6g}", str(sum(numbers["broken"] for numbers in chosen))])
    return markdown(header, lines)


def furnace_tables(rows: Sequence[dict]) -> list[str]:
    """Tables of scenes in which no sample weighs more than 1, of others, and of views from inside, where light is caught."""
    groups = {
        "White furnace: sharp media seen from outside": [row for row in rows if is_sharp(row) and not row["inside"]],
        "Rough or dispersing media seen from outside": [row for row in rows if not is_sharp(row) and not row["inside"]],
        "Views from inside": [row for row in rows if row["inside"]],
    }
    return [furnace_table(title, chosen) for title, chosen in groups.items() if chosen]


def is_sharp(row: dict) -> bool:
    """Whether no sample may weigh more than 1."""
    return not row["rough"] and not row["splits"]


def small(value: float) -> str:
    """A deviation with two digits; 0 for what rounding leaves."""
    return "0" if abs(value) < 5e-7 else f"{value:+.1e}"


def agreement_table(tables: dict[str, dict[str, dict]]) -> str:
    """In how many comparisons ways agree, and what would have shown."""
    header = ["Pictures that agree", "compared with", "comparisons", "beyond the limit", "least chance"]
    header += ["seen with 99 %: median difference of a tile"]
    lines = []
    for table, reference in (("random", LABELS["asked"]), ("split", LABELS["split"])):
        rows = list(tables.get(table, {}).values())
        for way in ("asked", "told", "cut", "native"):
            chances = [row["chances"][way] for row in rows if way in row["chances"]]
            if chances:
                visible = float(np.median([row["visible"] for row in rows if way in row["chances"]]))
                lines.append([LABELS[way], reference, *chance_cells(chances), f"{visible:.1%}"])
        naive = [row["naive"] for row in rows if "naive" in row]
        if naive:
            visible = float(np.median([row["visible"] for row in rows]))
            lines.append([LABELS["glass"], reference, *chance_cells(naive), f"{visible:.1%}"])
    return markdown(header, lines)


def chance_cells(chances: Sequence[float]) -> list[str]:
    """How many comparisons there are, how many fail, and the least chance of all."""
    failing = sum(chance < stress_rate() for chance in chances)
    return [str(len(chances)), f"**{failing}**" if failing else "0", f"{min(chances):.1g}"]


def far_table(table: str, rows: dict[str, dict]) -> str:
    """How far a scene is from white and from what it should look like, by one number."""
    ways = [way for way in LABELS if any(way in row["ways"] for row in rows.values())]
    header = [FAR[table], *(f"furnace: {LABELS[way]}" for way in ways), "least chance of ours", "of Glass"]
    lines = []
    for name, row in rows.items():
        cells = [small(row["ways"][way]["mean"]) if way in row["ways"] else "" for way in ways]
        naive = row.get("naive")
        lines.append([name, *cells, chance_cell(min(row["chances"].values())), chance_cell(naive)])
    return markdown(header, lines)


def chance_cell(chance: float | None) -> str:
    """A chance, bold where it is no noise."""
    if chance is None:
        return ""
    return f"**{chance:.1g}**" if chance < stress_rate() else f"{chance:.2g}"


def body_table(rows: dict[str, dict]) -> str:
    """Bodies that come into being in other ways: the chance that they look otherwise."""
    ways = ("asked", "told", "cut", "native")
    header = ["The same body by", *(LABELS[way] for way in ways), "furnace, worst"]
    lines = []
    for name, row in rows.items():
        worst = max((numbers["mean"] for way, numbers in row["ways"].items() if way in ways), key=abs)
        lines.append([name, *(chance_cell(row["chances"].get(way)) for way in ways), small(worst)])
    return markdown(header, lines)


def instance_table(rows: dict[str, dict]) -> str:
    """What many instances cost."""
    header = ["Instances", "prepare, CPU s", "first picture, told", "asked", "Glass split by hand", "least chance"]
    lines = []
    for name, row in rows.items():
        seconds = row["seconds"]
        cells = [f"{seconds[step]:.1f}" if step in seconds else "" for step in ("prepare", "told", "asked", "split")]
        lines.append([name, *cells, chance_cell(min(row["chances"].values()))])
    return markdown(header, lines)


def value_line(rows: dict[str, dict]) -> str:
    """What parameters at their limits make of white."""
    means = [numbers["mean"] for row in rows.values() for numbers in row["ways"].values()]
    broken = sum(numbers["broken"] for row in rows.values() for numbers in row["ways"].values())
    return (
        f"Parameters at either limit, {len(rows)} scenes: a white furnace deviates by {small(min(means))} to "
        f"{small(max(means))}, {broken} NaN or infinite."
    )


def page(tables: dict[str, dict[str, dict]]) -> str:
    """All of it in Markdown."""
    parts = [
        f"Chances are of a difference as large if there is none; below {stress_rate():.1e} it is taken for one, so that of "
        f"{STRESS_ASSERTIONS} comparisons of equal pictures one in {1 / SUITE:.0f} runs shows any."
    ]
    if "random" in tables:
        rows = list(tables["random"].values())
        media, seconds = sum(row["media"] for row in rows), sum(row["seconds"] for row in rows)
        whole = "" if len(rows) == len(SCENES) else f", the first of {len(SCENES)}: the others are not measured yet"
        parts.append(f"{len(rows)} random scenes of {media} media{whole}; {seconds / 60:.0f} minutes on the wall.")
        parts += [*furnace_tables(rows), "![Deviations of random scenes](results/stress_random.png)"]
    if "random" in tables or "split" in tables:
        parts.append(agreement_table(tables))
    parts += [far_table(table, tables[table]) for table in FAR if table in tables]
    if any(table in tables for table in FAR):
        parts.append("![Deviations far out](results/stress_far.png)")
    for table, write in (("body", body_table), ("instances", instance_table), ("value", value_line)):
        if table in tables:
            parts.append(write(tables[table]))
    return "\n\n".join(parts)


# Plots --------------------------------------------------------------------------------------------------------------


def plot_random(rows: Sequence[dict], path: Path) -> None:
    """Deviations of sharp random scenes, sorted, by way, to a PNG; noise of others would hide them."""
    rows = [row for row in rows if is_sharp(row)]
    figure = Figure(figsize=(7.0, 4.2), layout="constrained")
    axis = figure.subplots()
    for way, colour in STYLES.items():
        means = sorted(row["ways"][way]["mean"] for row in rows if way in row["ways"])
        if means:
            axis.plot(np.linspace(0.0, 100.0, len(means)), means, color=colour, label=LABELS[way])
    axis.set_yscale("symlog", linthresh=1e-5)
    axis.set_xlabel("scenes, %")
    axis.set_ylabel("deviation from white")
    axis.set_title(f"{len(rows)} random scenes of sharp media in a furnace")
    axis.grid(alpha=0.3)
    axis.legend()
    figure.savefig(path, dpi=100)


def plot_far(tables: dict[str, dict[str, dict]], path: Path) -> None:
    """Deviations by one number each, to a PNG."""
    shown = [table for table in FAR if table in tables]
    figure = Figure(figsize=(3.4 * len(shown), 3.6), layout="constrained")
    for axis, table in zip(np.atleast_1d(figure.subplots(1, len(shown))), shown):
        for way, colour in STYLES.items():
            points = [
                (float(name), row["ways"][way]["mean"]) for name, row in tables[table].items() if way in row["ways"]
            ]
            if points:
                axis.plot(*zip(*points), color=colour, marker=".", label=LABELS[way])
        axis.set_xscale("log")
        axis.set_yscale("symlog", linthresh=1e-5)
        axis.set_ylim(min(axis.get_ylim()[0], -1e-4), max(axis.get_ylim()[1], 1e-4))
        axis.set_xlabel(FAR[table])
        axis.grid(alpha=0.3)
    figure.axes[0].set_ylabel("deviation from white")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(STYLES))
    figure.savefig(path, dpi=100)


def main() -> None:
    """Write everything."""
    tables = measured()
    (RESULTS / "stress.json").write_text(json.dumps(tables, indent=1) + "\n", encoding="utf-8")
    if "random" in tables:
        plot_random(list(tables["random"].values()), RESULTS / "stress_random.png")
    if any(table in tables for table in FAR):
        plot_far(tables, RESULTS / "stress_far.png")
    renew("stress", page(tables))


if __name__ == "__main__":
    main()
