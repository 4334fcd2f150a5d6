"""Measurement: recordings and logs in every supported format, motion and its derivatives, checks against the robot."""
