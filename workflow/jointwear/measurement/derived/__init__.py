"""Velocity, acceleration and their noise from what was measured, and the samples that can be judged."""
