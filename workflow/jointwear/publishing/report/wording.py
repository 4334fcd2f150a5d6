"""The summary in plain words. Every sentence is made from the results; none is fixed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from jointwear.files.shown_numbers import number, percent
from jointwear.files.wording import count
from jointwear.reproduction.verdicts import AGREES, CLOSE, DIFFERS, NOT_COMPARABLE

Statement = dict[str, str]
#: What of Figures 1 to 3 is compared: the verdict on the figures is that on all of these.
FIGURE_SCORES = ("friction", "divergence", "residuals", "onset", "components")


def _overall(verdicts: Mapping[str, int]) -> str:
    """Condense verdicts: agrees if at least three quarters of what can be compared do, differs if less than half
    at least come close."""
    compared = sum(verdicts[v] for v in (AGREES, CLOSE, DIFFERS))
    if not compared:
        return NOT_COMPARABLE
    if verdicts[AGREES] >= 0.75 * compared:
        return AGREES
    return CLOSE if verdicts[AGREES] + verdicts[CLOSE] >= 0.5 * compared else DIFFERS


def _counted(verdicts: Mapping[str, int]) -> str:
    compared = sum(verdicts[v] for v in (AGREES, CLOSE, DIFFERS))
    text = f"{verdicts[AGREES]} of {compared} agree, {verdicts[CLOSE]} come close, {verdicts[DIFFERS]} differ"
    left = verdicts[NOT_COMPARABLE]
    return text + (f" ({count(left, 'run')} cannot be compared)" if left else "")


def _nothing(data: Mapping[str, Any]) -> str:
    """Say why nothing of a table can be compared."""
    if data["scores"]["table_iii"]["in_both"]:
        return "The runs end before the hours at which the paper's are read, so there is nothing to compare."
    return "The paper ran none of the runs in this grid, so there is nothing to compare."


def _detection(data: Mapping[str, Any]) -> Statement:
    score = data["scores"]["table_iv"]
    verdict = _overall(score["verdicts"])
    if verdict == NOT_COMPARABLE:
        return {"key": "table_iv", "title": "Hours of detection (Table IV)", "verdict": verdict, "text": _nothing(data)}
    text = (
        f"{_counted(score['verdicts'])}. Detected or not is the same as in the paper in {score['same_pattern']} of "
        f"{score['compared']} runs; {count(score['only_we_detect'], 'run')} detected only here, "
        f"{score['only_paper_detects']} only in the paper."
    )
    if score["median_error_h"] is not None:
        text += (
            f" Where both detect, the hours are {number(score['median_error_h'], 2)} h apart in the median and "
            f"{number(score['largest_error_h'], 2)} h at most."
        )
    return {"key": "table_iv", "title": "Hours of detection (Table IV)", "verdict": verdict, "text": text}


def _torque(data: Mapping[str, Any]) -> Statement:
    def says(score: Mapping[str, Any]) -> str:
        return (
            f"The error is {percent(score['median_error'], 1)} in the median and "
            f"{percent(score['largest_error'], 1)} at most; at the paper's own hours "
            f"{percent(score['median_error_at_published_hour'], 1)} and "
            f"{percent(score['largest_error_at_published_hour'], 1)}."
        )

    return _values(data, "table_v", "Maximum torque (Table V)", says)


def _variation(data: Mapping[str, Any]) -> Statement:
    def says(score: Mapping[str, Any]) -> str:
        return (
            f"The coefficient of variation is off by {number(score['median_error'], 2)} in the median and "
            f"{number(score['largest_error'], 2)} at most."
        )

    return _values(data, "table_vi", "Variation of the torque (Table VI)", says)


def _values(data: Mapping[str, Any], key: str, title: str, says: Callable[[Mapping[str, Any]], str]) -> Statement:
    """Table V or VI: counts of the verdicts, then what `says` makes of the errors."""
    score = data["scores"][key]
    text = _nothing(data) if score["median_error"] is None else f"{_counted(score['verdicts'])}. {says(score)}"
    return {"key": key, "title": title, "verdict": _overall(score["verdicts"]), "text": text}


def _lags(data: Mapping[str, Any]) -> Statement:
    score = data["scores"]["table_ii"]
    verdict, title = _overall(score["verdicts"]), "Lags between the axes (Table II)"
    if verdict == NOT_COMPARABLE:
        return {
            "key": "table_ii",
            "title": title,
            "verdict": verdict,
            "text": "The run of Table II is not in this grid.",
        }
    return {
        "key": "table_ii",
        "title": title,
        "verdict": verdict,
        "text": f"Of {score['pairs']} pairs of axes {score['verdicts'][AGREES]} agree, {score['verdicts'][CLOSE]} come "
        f"close, {score['verdicts'][DIFFERS]} differ: {score['same_sign']} have the paper's sign, and for "
        f"{score['inside_range']} the paper's lag lies in our range over replicates.",
    }


def _location(data: Mapping[str, Any]) -> Statement:
    location = data["location"]
    pooled, idle = location["pooled"], location["without_wear"]
    key, title = "location", "Location of the worn axis"
    if not pooled["chosen"]["total"]:
        text = "Nothing was detected, so nothing was located."
        return {"key": key, "title": title, "verdict": NOT_COMPARABLE, "text": text}
    share, printed = pooled["chosen"]["share"], data["paper"]["detected_total"]
    # "All but one" of the paper's detections is the lower of its two statements.
    verdict = AGREES if share >= (printed - 1) / printed else CLOSE if share >= 0.75 else DIFFERS
    if not data["scores"]["table_iii"]["in_both"]:
        verdict = NOT_COMPARABLE
    return {
        "key": key,
        "title": title,
        "verdict": verdict,
        "text": f"Where wear is detected, the paper's rule names the true axis in {percent(share)} of "
        f"{count(pooled['chosen']['total'], 'replicate')} with the chosen reading "
        f"({percent(pooled['raw']['share'])} with the means kept, as MATLAB's xcorr computes, "
        f"{percent(pooled['means_removed']['share'])} with the means removed, as equation (5) is printed); the paper "
        f"says all, or all but one. In normal periods without any wear the same rule still names an axis in "
        f"{percent(idle['chosen']['share'])} of the cases. Simply taking the axis whose KL divergence rose most names "
        f"the true one in {percent(pooled['shift']['share'])}.",
    }


def _alarms(data: Mapping[str, Any]) -> Statement:
    mean, weeks = data["detection"]["normal_mean"]["q"], data["detection"]["normal_pooled"]["q"]
    nominal = 1 - data["config"]["detection"]["confidence"]
    return {
        "key": "false_alarms",
        "title": "False alarms",
        "verdict": BEYOND,
        "text": f"The paper does not count them. A robot without wear raises {number(mean['alarms_per_week'], 2)} "
        f"alarms a week; {percent(weeks['share'])} of the normal periods have at least one. Q lies above its limit in "
        f"{percent(mean['hours_above_limit'], 1)} of the normal hours, by design it should be {percent(nominal)}.",
    }


def _figures(data: Mapping[str, Any]) -> Statement:
    figures = data["figures"]
    verdicts = {
        v: sum(figures[p]["verdict"] == v for p in FIGURE_SCORES) for v in (AGREES, CLOSE, DIFFERS, NOT_COMPARABLE)
    }
    peak, onset, kept = figures["divergence"], figures["onset"], figures["components"]
    where = f"{figures['task']}, axis {figures['axis']}, {number(figures['increase_percent'])} %"
    text = ""
    if figures["is_published_run"]:
        text = (
            f"The largest KL divergence of Figure 2 is {number(peak['peak_nat'], 2)} nat, in a plot of the paper that "
            f"reaches {number(peak['published'][1])} nat. "
        )
        if onset["detection_probability"] > 0:
            hour = number(onset["hour_median"])
            text += f"The onset of Figure 3 comes at hour {hour}, in the paper at {onset['published']}. "
    else:
        text = f"The run of the paper's figures is not in this grid, or not in its whole length; they show {where}. "
    text += (
        f"{percent(kept['share_inside'])} of our normal models keep {kept['published'][0]} to "
        f"{kept['published'][1]} principal components, as the paper's do."
    )
    return {"key": "figures", "title": "Figures 1 to 3", "verdict": _overall(verdicts), "text": text}


UNDECIDED = "not decided"
BEYOND = "not in the paper"


def _decision(correlation: Mapping[str, Any], sign: int) -> str:
    """Whether an interval speaks for (`supported`), against (`contradicted`) or neither way (`open`)."""
    low, high = sorted((sign * correlation["low"], sign * correlation["high"]))
    return "supported" if low > 0 else "contradicted" if high < 0 else "open"


def _claim(data: Mapping[str, Any]) -> Statement:
    rows = [r for r in data["drivers"]["measured"] if r["earliness"]["value"] is not None]
    key, title = "claim", "Low variability and high load decide detection"
    if not rows:
        text = "The grid has too few runs to test this claim."
        return {"key": key, "title": title, "verdict": NOT_COMPARABLE, "text": text, "conclusion": text}

    def values(predictor: str) -> str:
        return " and ".join(number(r["earliness"]["value"], 2, plus=True) for r in rows if r["predictor"] == predictor)

    def decisions(predictor: str, sign: int) -> set[str]:
        return {_decision(r["earliness"], sign) for r in rows if r["predictor"] == predictor}

    claimed = decisions("variation", -1) | decisions("load", 1)
    share = decisions("growth_share", 1)
    verdict = {True: AGREES}.get(claimed == {"supported"}, DIFFERS if "contradicted" in claimed else UNDECIDED)
    if verdict == UNDECIDED and "supported" in claimed:
        verdict = CLOSE
    found = {
        AGREES: "The grid supports the claim.",
        CLOSE: "The grid supports the claim in part.",
        DIFFERS: "The grid contradicts at least one half of the claim.",
        UNDECIDED: "Neither half of the claim shows in the grid: every interval holds zero.",
    }[verdict]
    if share == {"supported"} and verdict != AGREES:
        lowest = min(r["earliness"]["low"] for r in rows if r["predictor"] == "growth_share")
        better = (
            " What does go with early detection is how much the wear changes the torque of the axis in relation to its "
            "largest torque: the share of the friction, not load or variability alone"
            + (", though the evidence is weak (an interval begins near zero)." if lowest < 0.1 else ".")
        )
    elif "supported" in share:
        better = (
            " The share by which the wear changes the torque goes with early detection for one of the growths only."
        )
    else:
        better = " Nor is the share by which the wear changes the torque a clear predictor in this grid."
    growths = " and ".join(f"{number(g)} %" for g in sorted({r["increase_percent"] for r in rows}))
    text = (
        f"{found}{better} Rank correlations with early detection, for growths of {growths}: variability "
        f"{values('variation')} (the claim expects it negative), load {values('load')} (expected positive), share of "
        f"the growth {values('growth_share')}."
    )
    return {"key": key, "title": title, "verdict": verdict, "text": text, "conclusion": found + better}


def _payload(data: Mapping[str, Any]) -> Statement:
    robot = data["robot"]
    payload = robot["payload"]
    text = (
        "The paper never mentions a payload, but the torques that it prints are out of reach of an unloaded PUMA 560 "
        "in slow motion. "
    )
    if payload and payload["mass"]:
        text += f"The robot {robot['name']} of this run carries {number(payload['mass'], 3)} kg."
        if robot["provenance"].get("source"):
            text += f" Its file says: {robot['provenance']['source']}."
    else:
        text += f"The robot {robot['name']} of this run carries none."
    return {"key": "payload", "title": "A hidden payload", "verdict": BEYOND, "text": text}


def summary(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the summary: `totals` of verdicts over Tables II, IV, V and VI, and one statement a finding."""
    tables = ("table_ii", "table_iv", "table_v", "table_vi")
    totals = {
        v: sum(data["scores"][t]["verdicts"][v] for t in tables) for v in (AGREES, CLOSE, DIFFERS, NOT_COMPARABLE)
    }
    statements = [
        make(data) for make in (_detection, _torque, _variation, _lags, _location, _figures, _claim, _alarms, _payload)
    ]
    design = data["scores"]["table_iii"]
    known, printed = design["in_both"], design["published_runs"]
    part = f"all {printed}" if known == printed else f"{known} of the {printed}" if known else "none of the"
    scope = (
        f"{count(design['runs'], 'worn run')}, each simulated {count(design['replicates'], 'time')}; they include "
        f"{part} runs of the paper."
    )
    return {
        "totals": totals,
        "compared": totals[AGREES] + totals[CLOSE] + totals[DIFFERS],
        "scope": scope,
        "statements": statements,
    }
