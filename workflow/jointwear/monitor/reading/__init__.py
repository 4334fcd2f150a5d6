"""Logs to window statistics: what a log tells, whether it belongs to the robot, and its windows as files."""
