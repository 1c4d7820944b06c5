"""Plots and tables of the benchmark's results."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from bench_errors import Floor
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

README = Path(__file__).resolve().parent / "README.md"

LABELS = {
    "naive": "naive Glass",
    "split": "hand-split Glass",
    "passed": "Glass and hidden faces",
    "plain": "Glass without OSL",
    "cut": "cut surfaces",
    "asking": "asking the scene",
    "native": "Cycles' own nodes",
    "brute": "one render a wavelength",
    "luxcore": "LuxCore",
    "mitsuba": "Mitsuba",
}

NESTED = ("cut", "asking", "native")
"""Ways of nested dielectrics."""

STYLES = {
    "naive": {"color": "tab:red"},
    "split": {"color": "black"},
    "cut": {"color": "tab:blue"},
    "asking": {"color": "tab:cyan", "linestyle": "--"},
    "native": {"color": "tab:purple"},
    "brute": {"color": "tab:gray"},
    "luxcore": {"color": "tab:green"},
    "mitsuba": {"color": "tab:orange"},
}


# Plots --------------------------------------------------------------------------------------------------------------


def seconds_per_sample(result: dict, way: str) -> float:
    """CPU seconds of a whole picture's sample: hand-split Glass's times the ratio of the way's."""
    timing = result["timing"]
    split = timing["cpu_microseconds_per_sample"] * 1e-6 * result["resolution"] ** 2
    # One render a wavelength samples as Glass does; what it exports anew is left out.
    return split * (1.0 if way == "brute" else timing["ways"][way]["ratio"])


def plot(result: dict, path: Path) -> None:
    """Error against time, by pixels and by blocks, to a PNG."""
    figure = Figure(figsize=(9.0, 4.4), layout="constrained")
    for axis, part, title in zip(figure.subplots(1, 2), ("", "block_"), ("pixels", "8 x 8 blocks"), strict=True):
        for way in sorted(result["errors"], key=list(LABELS).index):
            draw(axis, result, way, part)
        axis.set_xscale("log")
        axis.set_yscale("log")
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.yaxis.set_minor_formatter(NullFormatter())
        axis.set_xlabel("CPU seconds of sampling")
        axis.set_title(title)
        axis.grid(alpha=0.3)
        axis.set_ylabel("relative mean square error")
    figure.suptitle(f"{result['title']}, {result['resolution']} x {result['resolution']}")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    figure.savefig(path, dpi=100)


def draw(axis: Axes, result: dict, way: str, part: str) -> None:
    """One way's curve, and where it cannot go below."""
    points = result["errors"][way]["points"]
    times = np.array([point["samples"] for point in points]) * seconds_per_sample(result, way)
    errors = np.array([point[part + "relmse"] for point in points])
    shown = errors > 0.0
    axis.plot(times[shown], errors[shown], marker=".", label=LABELS[way], **STYLES[way])
    lowest = Floor(**result["errors"][way][part + "floor"])
    if lowest.certain:
        axis.axhline(lowest.relmse, color=STYLES[way]["color"], linestyle=":", linewidth=1.0)


# Tables -------------------------------------------------------------------------------------------------------------


def tables(results: Sequence[dict]) -> str:
    """All tables in Markdown."""
    return "\n\n".join((time_table(results), cost_table(results), error_table(results), *remarks(results)))


def renew(name: str, content: str) -> None:
    """Write other content between two marks of README.md."""
    README.write_text(renewed(README.read_text(), name, content))


def renewed(text: str, name: str, content: str) -> str:
    """A page with other content between its two marks of that name."""
    first, last = f"<!-- {name}: begin -->", f"<!-- {name}: end -->"
    before, begin, rest = text.partition(first)
    _, end, after = rest.partition(last)
    if not begin or not end:
        raise ValueError(f"the page needs the lines {first} and {last}")
    return f"{before}{first}\n\n{content}\n\n{last}{after}"


def markdown(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table whose first column is of words."""
    lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def time_table(results: Sequence[dict]) -> str:
    """Sampling time as a multiple of hand-split Glass's."""
    shown = [
        way for way in LABELS if way not in ("split", "brute") and any(way in r["timing"]["ways"] for r in results)
    ]
    header = [
        "Time of sampling, hand-split Glass = 1",
        "Glass, CPU µs a sample",
        *(LABELS[way] for way in shown),
        "Cycles' own nodes, Glass without OSL = 1",
        "rounds",
    ]
    rows = []
    for result in results:
        timing = result["timing"]
        cells = [ratio_cell(timing["ways"].get(way)) for way in shown] + [plain_cell(timing["ways"])]
        micros = f"{timing['cpu_microseconds_per_sample']:.1f}"
        rows.append([result["title"], micros, *cells, str(len(timing["ways"]["split"]["ratios"]))])
    return markdown(header, rows)


def ratio_cell(way: dict | None) -> str:
    """A ratio and its range over the rounds."""
    if way is None:
        return ""
    return f"{way['ratio']:.2f} ({min(way['ratios']):.2f}–{max(way['ratios']):.2f})"


def plain_cell(ways: dict) -> str:
    """The ratio of media in Cycles' own nodes to hand-split Glass without OSL in the same round, and its range."""
    if not {"native", "plain"} <= ways.keys():
        return ""
    ratios = [native / plain for native, plain in zip(ways["native"]["cpu"], ways["plain"]["cpu"], strict=True)]
    return ratio_cell({"ratio": statistics.median(ratios), "ratios": ratios})


def cost_table(results: Sequence[dict]) -> str:
    """Preparation and memory."""
    header = ["CPU s and MB"]
    for way in ("Glass", LABELS["plain"]):
        header += [f"{way}: first sample", "again", "MB"]
    for way in NESTED:
        header += [f"{LABELS[way]}: prepare", "first sample", "again", "MB"]
    rows = []
    for result in results:
        cells = cost_cells(result, "split")[1:] + cost_cells(result, "plain")[1:]
        for way in NESTED:
            cells += cost_cells(result, way)
        rows.append([result["title"], *cells])
    return markdown(header, rows)


def cost_cells(result: dict, way: str) -> list[str]:
    """CPU seconds of preparing, of the first sample and of what a further render costs besides samples, and MB."""
    if way not in result["preparation"]:
        return [""] * 4
    preparation = result["preparation"][way]
    seconds = [preparation[step]["cpu"] for step in ("prepare", "first_render")]
    seconds.append(result["timing"]["ways"][way]["again_cpu"])
    return [*(f"{value:.2f}" for value in seconds), f"{result['memory'][way]['scene']:.0f}"]


def error_table(results: Sequence[dict]) -> str:
    """Errors at the most samples, and what is left without noise."""
    floored = [
        way for way in LABELS if way not in ("split", "plain") and any(way in result["errors"] for result in results)
    ]
    header = ["Error (relMSE) × 10⁶", "samples", "Glass", *(LABELS[way] for way in NESTED)]
    header += [f"floor: {LABELS[way]}" for way in floored]
    rows = []
    for result in results:
        errors = result["errors"]
        last = [errors[way]["points"][-1] if way in errors else None for way in ("split", *NESTED)]
        cells = [floor_cell(errors[way]["floor"]) if way in errors else "" for way in floored]
        rows.append(
            [result["title"], str(last[0]["samples"]), *(millionths(p["relmse"]) if p else "" for p in last), *cells]
        )
    return markdown(header, rows)


def floor_cell(found: dict) -> str:
    """A floor with its standard error, bold where it is one."""
    text = f"{millionths(found['relmse'])} ± {millionths(found['standard_error'])}"
    return f"**{text}**" if Floor(**found).certain else text


def millionths(value: float) -> str:
    """A number times 10⁶ with two digits."""
    return f"{float(f'{value * 1e6:.2g}'):.10g}"


def remarks(results: Sequence[dict]) -> list[str]:
    """Where cut surfaces are better than naive Glass ever gets."""
    found = []
    for result in results:
        if "naive" not in result["errors"]:
            continue
        lowest = Floor(**result["errors"]["naive"]["floor"])
        if lowest.certain:
            samples = samples_for(result["errors"]["cut"]["points"], lowest.relmse)
            found.append(
                f"- {result['title']}: cut surfaces are as good as naive Glass with any number of samples after "
                f"{samples:.3g} samples, {samples * seconds_per_sample(result, 'cut'):.2g} CPU seconds."
            )
    return ["\n".join(found)] if found else []


def samples_for(points: Sequence[dict], error: float) -> float:
    """Samples at which a curve reaches an error, along straight lines on log-log paper, the ends' drawn on."""
    counts, errors = (
        np.log([point[key] for point in points if point["relmse"] > 0.0]) for key in ("samples", "relmse")
    )
    place = int(np.clip(np.searchsorted(-errors, -np.log(error)), 1, len(errors) - 1))
    slope = (counts[place] - counts[place - 1]) / (errors[place] - errors[place - 1])
    return float(np.exp(counts[place - 1] + (np.log(error) - errors[place - 1]) * slope))
