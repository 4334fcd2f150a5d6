# What the study of the monitor takes from the reproduction, task by task, and how large it is.
MONITOR_TASKS = config["tasks"]
MONITOR_SCENARIOS = ["temperature", "payload", "speed", "all"]
MONITOR_STUDY_FIGURES = ["hours", "curves", "factory"]
STUDY_PICTURES["monitor_study"] = MONITOR_STUDY_FIGURES
# The paper's detector as the reproduction has it.
MONITOR_PAPER = {
    "bins": config["histogram"]["bins"],
    "confidence": config["detection"]["confidence"],
    "variance_share": config["detection"]["variance_share"],
    "consecutive_hours": config["detection"]["consecutive_hours"],
}


def runs_of(stage, *more):
    """An input function: files of a stage for all runs of a task, worn ones and those named."""
    return lambda wildcards: expand(
        "results/{stage}/{task}/{run}.nc",
        stage=stage,
        task=wildcards.task,
        run=[*more, *CELLS],
    )
