"""Changes of one parameter that a reader may try; `make bench` measures what each costs."""

from __future__ import annotations

EDITS = (
    {
        "command": "snakemake --config 'report={replicate: 2}'",
        "what": "Show another replicate in the single-run figures and in Table II.",
    },
    {
        "command": "snakemake --config 'reading={lag_peak: absolute_maximum}'",
        "what": "Take the lag at the largest size of the cross-correlation: location alone runs again.",
    },
    {
        "command": "snakemake --config 'detection={consecutive_hours: 3}'",
        "what": "Call it an onset after three hours above the limit instead of five.",
    },
    {
        "command": "snakemake --config 'detection={confidence: 0.99}'",
        "what": "Another confidence of the control limits: normal models and scores run again, no simulation.",
    },
    {
        "command": "snakemake --config 'histogram={bins: 20}'",
        "what": "Twenty bins in the histograms: everything after the simulation runs again.",
    },
    {
        "command": "snakemake --config 'wear={increase_percent: [10, 20, 30]}'",
        "what": "One more growth of friction: its own cells are computed, the others stay.",
    },
    {
        "command": "snakemake --config 'wear={shape: 2.5}'",
        "what": "Another course of the wear: all worn runs are simulated again, training stays.",
    },
    {
        "command": "snakemake --config replicates=20",
        "what": "A fifth of the replicates.",
    },
    {
        "command": "snakemake --config seed=7",
        "what": "Other random numbers: everything runs again.",
    },
)
