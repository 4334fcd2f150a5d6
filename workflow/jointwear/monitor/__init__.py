"""Monitor a robot on its own logs: friction of every axis over time, alarms, and what cannot be judged.

Logs become :class:`~jointwear.monitor.windows.WindowStatistics` (readers, clock, derivation, accumulate); these are
judged; :mod:`jointwear.monitor.stages` reads and writes files for the workflow.
"""
