"""A robot's own model: discovery on the logs of its baseline, handed on to the monitor.

Logs -> stretches of motion (gather) -> programs (programs) -> one recording (selection) -> discovery, and a check of
what it wrote on motion that it has not seen (stage).
"""
