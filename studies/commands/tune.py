"""The cheapest setting of an estimator for a tolerance."""

from typing import Annotated

import numpy as np
import pandas as pd
import typer

from estimators import FixedWindow
from sim import checks
from studies import catalogue, seeds
from studies.commands.runs import key_and_value
from studies.commands.terminal import console, one_line_errors
from studies.prediction import sonar_of
from studies.quantity import number_in
from studies.statistics import Interval
from studies.tuning import QUICK, USUAL, Judged, Target, Tolerance, Tuned, target_of, tuned


def tune(
    file: Annotated[
        str | None, typer.Argument(help="A study with one patch or scene that says sonar, looks and coherence.")
    ] = None,
    sonar: Annotated[str | None, typer.Option(help="Name of a sonar; hisas-100khz where there is no study.")] = None,
    looks: Annotated[int | None, typer.Option(help="Independent looks in the window.")] = None,
    coherence: Annotated[float | None, typer.Option(help="Coherence of both series, 0 to 1.")] = None,
    snr: Annotated[str | None, typer.Option(help="Signal-to-noise ratio of either receiver [dB] instead.")] = None,
    over_bound: Annotated[str, typer.Option(help="What the STD may exceed the bound by, as 5% or 0.05.")] = "5%",
    wrap_rate: Annotated[float, typer.Option(help="Largest wrap-error rate.")] = 1e-3,
    delay: Annotated[float | None, typer.Option(help="True delays are within so many wraps; .5 by default.")] = None,
    setting: Annotated[
        list[str] | None, typer.Option("--set", help="Another value of the study, as KEY=VALUE; may be repeated.")
    ] = None,
    seed: Annotated[int, typer.Option(help="Root of all random numbers.")] = 2026,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer trials and repeats.")] = False,
) -> None:
    """Find the cheapest estimator and setting that meet a tolerance: timed, and confirmed by simulation."""
    with one_line_errors():
        seeds.check(seed)
        target = _target(file, sonar, dict(key_and_value(text) for text in setting or []))
        condition = target.condition(looks, _coherence(coherence, snr), delay)
        tolerance = Tolerance(_share(over_bound), wrap_rate)
        rng = np.random.Generator(np.random.Philox(seed))
        found = tuned(condition, tolerance, rng, QUICK if quick else USUAL)
        console.print(said(found, target.source), soft_wrap=True)


def said(found: Tuned, source: str) -> str:
    """The answer with a short table, as the terminal shows it."""
    asked, where = found.tolerance, found.condition
    lines = [
        f"{source}: {where.looks} looks, coherence {where.coherence:.4g}, delays within {where.delay:g} wraps, "
        f"B/fc = {where.sonar.relative_bandwidth:.3g}",
        f"asked for: STD/CRLB at most {asked.std_over_crlb:g}, wrap rate at most {asked.wrap_rate:g}",
    ]
    shown = [("next cheaper", found.cheaper), ("cheapest that meets it", found.best), ("next better", found.better)]
    if found.best is None:
        lines.append(f"{_none(found)}{_needed(found)}")
        shown = [("nearest", found.nearest)]
    rows = [_row(role, one) for role, one in shown if one is not None]
    lines.append(pd.DataFrame(rows).to_string(index=False))
    for role, one in shown:
        if one is None:
            lines.append(f"{role}: none")
        elif one.fails:
            lines.append(f"{role} fails: {one.fails}")
    if found.best is not None:
        setting = found.best.setting
        windows = (FixedWindow(1, samples) for samples in (where.looks, where.looks_of(setting.wide)))
        lines.append(f"in Python, with a sample for each look: {setting.build(*windows)}")
    lines.append("99 % intervals in brackets; quartiles of the time; a copy is that of both series; trials of the STD")
    return "\n".join(lines)


def _row(role: str, one: Judged) -> dict[str, str]:
    nano = [1e9 * value for value in one.seconds_per_pixel]
    return {
        "": role,
        "setting": one.setting.name,
        "ns a pixel": "{:.0f} [{:.0f}, {:.0f}]".format(*nano),
        "copies": f"{one.copies.median:.0f}",
        "STD/CRLB": _interval(one.std_over_crlb, ".4g"),
        "wrap rate": _interval(one.wrap_rate, ".2g"),
        "trials": str(one.trials),
    }


def _interval(interval: Interval, digits: str) -> str:
    value, low, high = (format(number, digits) for number in interval)
    return f"{value} [{low}, {high}]"


def _none(found: Tuned) -> str:
    """That none does, or that so many trials do not tell."""
    open_ones = sum(not one.beyond(found.tolerance) for one in found.judged)
    if not open_ones:
        return "no setting meets it"
    return f"no setting is confirmed to meet it; {open_ones} are not ruled out by so many trials"


def _needed(found: Tuned) -> str:
    if found.looks_needed is None:
        return ""
    return f"; a cross-correlation is predicted to with {found.looks_needed} looks"


def _target(file: str | None, sonar: str | None, values: dict[str, object]) -> Target:
    if file is None:
        if values:
            raise ValueError("--set is given without a study; it must be with one")
        name = sonar or "hisas-100khz"
        return Target(sonar_of(name), source=name)
    if sonar is not None:
        raise ValueError(f"sonar is {sonar!r} beside a study, which has one; it must be one of them")
    return target_of(catalogue.study(file).with_values(values))


def _coherence(coherence: float | None, snr: str | None) -> float | None:
    if snr is None:
        return coherence
    if coherence is not None:
        raise ValueError("coherence and snr are both given; it must be one of them")
    try:
        level = number_in(snr, "dB")
    except ValueError as error:
        raise ValueError(f"snr is {snr!r}: {error}") from None
    return 1 / (1 + 10 ** (-checks.within("snr", level, -20, 40, "dB") / 10))


def _share(text: str) -> float:
    number = text.strip()
    percent = number.endswith("%")
    try:
        value = float(number.removesuffix("%"))
    except ValueError:
        raise ValueError(f"over_bound is {text!r}; it must be a number, or a percentage such as 5%") from None
    return value / 100 if percent else value
