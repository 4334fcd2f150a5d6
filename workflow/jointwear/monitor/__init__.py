"""Monitor a robot on its own logs: friction of every axis over time, alarms, and what cannot be judged.

Logs become :class:`~.windows.WindowStatistics` (readers, clock, derivation, accumulate); these are
judged; :mod:`jointwear.monitor.reading.reading_stages` and :mod:`jointwear.monitor.stages` read and write files for the
workflow.
"""
