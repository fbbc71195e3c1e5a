"""`mitl characterise`: what recordings say about a tracker. A thin wrapper over `metrics.tracker_statistics`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from mitl.metrics.tracker_statistics import TrackerStatistics
    from mitl.paths import FloatArray


@click.command(
    "characterise",
    short_help="Statistics of a tracker from its recordings.",
    epilog="Example: mitl characterise static/measurementPoint*.txt --format json",
)
@click.argument("files", nargs=-1, required=True, metavar="FILE...", type=click.Path(path_type=Path))
@click.option("--topic", metavar="TOPIC", help="The MCAP topic to look at; else every topic that ends in /tracker/pose.")
@click.option("--columns", metavar="MAP", help="Read tables of another tracker: t=COLUMN,x=COLUMN,... or vicon, optitrack, laser, egm.")
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
def characterise_command(files: tuple[Path, ...], topic: str | None, columns: str | None, form: str) -> None:
    """Tells rate, dropouts, jitter by window, Allan deviation, noise and drift of a tracker.

    FILE is MCAP, the CSV of `mitl oracle`, TUM text (t x y z qx qy qz qw), or the text of the Vive-Accuracy-Experiment. Noise is taken
    where the body stands still. Jitter is the diameter of the points in a window. Of several recordings the medians are told too.
    """
    # heavy imports only when the command runs: `mitl --help` loads neither SciPy nor MCAP
    import json  # noqa: PLC0415 - see above

    from mitl.cli.progress import Progress  # noqa: PLC0415 - see above
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.metrics.tracker_statistics import tracker_statistics  # noqa: PLC0415 - see above
    from mitl.recording.csv_import import ColumnMap  # noqa: PLC0415 - see above
    from mitl.recording.read import read_tracker_recordings  # noqa: PLC0415 - see above

    column_map = None if columns is None else ColumnMap.parse(columns)
    found: list[dict[str, Any]] = []
    with Progress("characterise") as progress:
        for file in files:
            progress.at(str(file))
            for recording in read_tracker_recordings(file, topic, column_map):
                if recording.damage:
                    click.echo(f"warning: {recording.name}: {recording.damage}; what was before is told", err=True)
                try:
                    statistics = tracker_statistics(recording.path)
                except ValueError as error:
                    raise UsageError(f"{recording.name}: {error}") from error
                found.append({"file": recording.name, "rate_is_nominal": recording.nominal, **_as_json(statistics)})
    together = _together(found)
    if form == "json":
        click.echo(json.dumps({"recordings": found, "together": together}))
        return
    for each in found:
        click.echo(_text(each))
    if len(found) > 1:
        click.echo(_text({"file": f"together, medians of {len(found)} recordings", **together}))


def _as_json(s: TrackerStatistics) -> dict[str, Any]:
    """Gives statistics in the units of the output."""
    noise, drift = s.noise, s.drift
    return {
        "samples": s.samples,
        "duration_s": s.duration,
        "rate_hz": s.rate,
        "interval_sd_s": s.interval_sd,
        "missing_samples": s.missing,
        "longest_gap_s": s.longest_gap,
        "invalid_samples": s.invalid,
        "losses": s.losses,
        "frozen_samples": s.frozen,
        "still_s": s.still,
        "jitter": [
            {
                "window_s": j.window,
                "mean_m": j.mean,
                "sd_m": j.sd,
                "median_m": j.median,
                "min_m": j.smallest,
                "max_m": j.largest,
                "windows": j.windows,
            }
            for j in s.jitter
        ],
        "mean_500ms_sd_m": _list(s.mean_sd),
        "mean_500ms_sd_deg": _list(s.mean_turn_sd, 57.29577951308232),
        "allan": [{"tau_s": tau, "deviation_m": row} for tau, row in zip(s.allan_time.tolist(), s.allan.tolist(), strict=True)],
        "noise": None
        if noise is None
        else {"fast_sd_m": noise.fast_sd, "fast_tau_s": noise.fast_tau, "random_walk_m_per_sqrt_s": noise.walk},
        "drift": None
        if drift is None
        else {
            "duration_s": drift.duration,
            "minute_means_sd_m": _list(drift.sd),
            "minute_means_range_m": _list(drift.range),
            "slope_m_per_h": _list(drift.slope, 3600.0),
        },
    }


def _list(values: FloatArray | None, factor: float = 1.0) -> list[float] | None:
    return None if values is None else [float(value) * factor for value in values]


def _together(found: list[dict[str, Any]]) -> dict[str, Any]:
    """Gives medians over recordings: some places are far worse than others, which a mean would make everybody's fault."""
    from statistics import median  # noqa: PLC0415 - only here

    windows = sorted({j["window_s"] for each in found for j in each["jitter"]})
    jitter = []
    for window in windows:
        means = [j["mean_m"] for each in found for j in each["jitter"] if j["window_s"] == window]
        jitter.append(
            {
                "window_s": window,
                "mean_m": median(means),
                "min_m": min(means),
                "max_m": max(means),
                "mean_of_means_m": sum(means) / len(means),
                "recordings": len(means),
            }
        )
    result: dict[str, Any] = {"recordings": len(found), "jitter": jitter}
    for key in ("mean_500ms_sd_m", "mean_500ms_sd_deg"):
        values = [value for each in found if each[key] for value in each[key]]
        result[key] = median(values) if values else None
    noises = [each["noise"] for each in found if each["noise"]]
    result["noise"] = {key: median(noise[key] for noise in noises) for key in noises[0]} if noises else None
    return result


def _text(each: dict[str, Any]) -> str:
    """Gives the lines of one recording, or of several together, in mm, ms and deg."""
    lines = [each["file"]]
    if "samples" in each:
        nominal = " (nominal: the file has no times)" if each["rate_is_nominal"] else f", intervals +- {each['interval_sd_s'] * 1e3:.3g} ms"
        lines.append(f"  rate      {each['rate_hz']:.6g} Hz{nominal}; {each['samples']} samples in {each['duration_s']:.6g} s")
        lines.append(
            f"  dropouts  {each['missing_samples']} missing, longest gap {each['longest_gap_s'] * 1e3:.4g} ms,"
            f" {each['invalid_samples']} invalid in {each['losses']} losses, {each['frozen_samples']} frozen"
        )
        lines.append(f"  still     {each['still_s']:.6g} s" + ("" if each["jitter"] else ": too short for noise figures"))
    for j in each["jitter"]:
        tail = f"sd {j['sd_m'] * 1e3:.3f}, of {j['windows']} windows" if "windows" in j else f"of {j['recordings']} recordings"
        span = f"{j['min_m'] * 1e3:.3f} to {j['max_m'] * 1e3:.3f}"
        lines.append(f"  jitter    {j['window_s'] * 1e3:5.0f} ms: {j['mean_m'] * 1e3:.3f} mm ({span}), {tail}")
    if each["mean_500ms_sd_m"] is not None:
        mm, deg = (value if isinstance(value, list) else [value] for value in (each["mean_500ms_sd_m"], each["mean_500ms_sd_deg"]))
        lines.append(f"  means     500 ms: sd {_row(mm, 1e3)} mm, {_row(deg, 1.0)} deg")
    if each["noise"]:
        n = each["noise"]
        lines.append(
            f"  noise     fast {n['fast_sd_m'] * 1e3:.3f} mm / {n['fast_tau_s'] * 1e3:.3g} ms,"
            f" random walk {n['random_walk_m_per_sqrt_s'] * 1e3:.3f} mm/sqrt(s), per axis"
        )
    lines += [f"  allan     {a['tau_s']:8.4g} s: {_row(a['deviation_m'], 1e3)} mm" for a in each.get("allan", [])[::3]]
    if each.get("drift"):
        d = each["drift"]
        lines.append(
            f"  drift     over {d['duration_s'] / 60:.4g} min: range {_row(d['minute_means_range_m'], 1e3)} mm,"
            f" sd {_row(d['minute_means_sd_m'], 1e3)} mm, {_row(d['slope_m_per_h'], 1e3)} mm/h"
        )
    return "\n".join(lines)


def _row(values: list[float], factor: float) -> str:
    return " ".join(f"{value * factor:.3f}" for value in values)
