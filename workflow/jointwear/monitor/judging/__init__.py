"""From windows to states and alarms: the order in which a robot is judged, and the files of it."""
