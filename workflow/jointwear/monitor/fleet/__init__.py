"""Many robots in one job: starting a job costs more than judging a robot."""
