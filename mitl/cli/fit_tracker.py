"""`mitl fit-tracker`: a tracker preset from still recordings. A thin wrapper over `metrics.tracker_fit` and `trackers.fit`."""

from __future__ import annotations

from pathlib import Path

import click


@click.command(
    "fit-tracker",
    short_help="Fit a tracker preset to still recordings.",
    epilog="Example: mitl fit-tracker still-*.mcap --output my-tracker.toml",
)
@click.argument("recordings", nargs=-1, required=True, metavar="RECORDING...", type=click.Path(path_type=Path))
@click.option("--output", type=click.Path(dir_okay=False, path_type=Path), help="Write the preset here; its name is the file's.")
@click.option("--base", default="lighthouse2", show_default=True, help="Preset that the rest is taken from.")
@click.option("--check", "held_back", multiple=True, type=click.Path(path_type=Path), help="A recording held back to check the fit with.")
@click.option("--columns", metavar="MAP", help="Read tables of another tracker: t=COLUMN,x=COLUMN,... or vicon, optitrack, laser, egm.")
@click.option("--format", "form", type=click.Choice(("text", "json")), default="text", show_default=True, help="Form of the output.")
def fit_tracker_command(
    recordings: tuple[Path, ...], output: Path | None, base: str, held_back: tuple[Path, ...], columns: str | None, form: str
) -> None:
    """Fits the noise of a tracker to recordings in which it stands still, one RECORDING a place.

    Noise over time, its direction, how places differ, and the rate are fitted; scale, drift, sleep and the like need other
    recordings and come from the base preset. Formats are those of `mitl characterise`.
    """
    # heavy imports only when the command runs: `mitl --help` loads neither SciPy nor MCAP
    import json  # noqa: PLC0415 - see above

    import numpy as np  # noqa: PLC0415 - see above

    from mitl.cli.progress import Progress  # noqa: PLC0415 - see above
    from mitl.errors import UsageError  # noqa: PLC0415 - see above
    from mitl.metrics.tracker_fit import fit_tracker, place_jitter  # noqa: PLC0415 - see above
    from mitl.recording.csv_import import ColumnMap  # noqa: PLC0415 - see above
    from mitl.recording.read import read_tracker_recordings  # noqa: PLC0415 - see above
    from mitl.simulation.tracker_parameters import load_preset  # noqa: PLC0415 - see above
    from mitl.trackers.fit import fitted_preset, predicted_jitter, preset_text, write_preset  # noqa: PLC0415 - see above

    column_map = None if columns is None else ColumnMap.parse(columns)
    load_preset(base)  # a wrong name is told before the work
    with Progress("fit-tracker") as progress:
        progress.at("reading")
        found = [recording for file in recordings for recording in read_tracker_recordings(file, columns=column_map)]
        others = [recording for file in held_back for recording in read_tracker_recordings(file, columns=column_map)]
        progress.at("fitting")
        try:
            fit = fit_tracker([recording.path for recording in found])
        except ValueError as error:
            raise UsageError(f"{', '.join(str(file) for file in recordings[:3])}: {error}") from error
        name = output.stem if output is not None else "fitted"
        preset = fitted_preset(fit, name, base)
        predicted = {window: predicted_jitter(preset, window) for window in (0.2, 0.5)}
        source = f"fit to {len(found)} still recordings"
        if output is not None:
            write_preset(output, preset_text(preset, base, source))
    noise, turn = preset.position_noise, preset.orientation_noise
    rows: list[tuple[str, float, str]] = [
        ("rate_hz", preset.sampling.rate_hz, "Hz"),
        ("fast_sd_m", noise.fast_sd_m, "m"),
        ("fast_tau_s", noise.fast_tau_s, "s"),
        ("slow_sd_m", noise.slow_sd_m, "m"),
        ("slow_tau_s", noise.slow_tau_s, "s"),
        ("fast_sd_deg", turn.fast_sd_deg, "deg"),
        ("gain_median", preset.location.gain_median, ""),
        ("gain_sd_log", preset.location.gain_sd_log, ""),
    ]
    # how far the typical jitter of other places may be off, as a factor, one standard deviation: places differ, and there are few
    place_factor = float(np.exp(fit.gain_sd_log / np.sqrt(len(found))))
    checks = []
    for window, jitter in predicted.items():
        typical = float(np.median(jitter))
        entry = {"window_s": window, "predicted_m": typical, "fitted_m": float(np.median([place_jitter(r.path, window) for r in found]))}
        if others:
            entry["held_back_m"] = float(np.median([place_jitter(r.path, window) for r in others]))
        checks.append(entry)
    if form == "json":
        told = {
            "place_factor": place_factor,
            "name": name,
            "recordings": len(found),
            "parameters": {key: value for key, value, _ in rows},
            "jitter": checks,
        }
        click.echo(json.dumps(told))
        return
    for key, value, unit in rows:
        click.echo(f"{key:<12} {value:.4g} {unit}".rstrip())
    for entry in checks:
        held = f", held back {1e3 * entry['held_back_m']:.3f} mm" if "held_back_m" in entry else ""
        click.echo(
            f"jitter {entry['window_s'] * 1e3:.0f} ms, median place: predicted {1e3 * entry['predicted_m']:.3f} mm,"
            f" recordings {1e3 * entry['fitted_m']:.3f} mm{held}"
        )
    click.echo(
        f"places differ by a factor of {np.exp(fit.gain_sd_log):.2f}: of {len(found)} the typical one is known to {place_factor:.2f}"
    )
    if output is not None:
        click.echo(f"preset: {output}", err=True)
