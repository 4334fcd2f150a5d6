# What the rules of discover.smk take from the entry of their data set.
from jointwear.robots.robot_file import robot_sources
from jointwear.files.documents import read_yaml
from jointwear.measurement.log_kinds import log_sources
from jointwear.running.datasets import written_for

# The data set that the report shows; `discover` takes it too where the config names none.
SHOWN_DATASET = "puma560_hidden"
SHIPPED_DATASETS = {
    name: entry
    for example in shipped_glob("config/examples/discover_*.yaml")
    for name, entry in read_yaml(str(example))["discover"]["datasets"].items()
}
# Those that need nothing from elsewhere; `everything` takes them all where the registered data are at hand.
OWN_DATASETS = [
    name
    for name, entry in SHIPPED_DATASETS.items()
    if Path(shipped(entry["measured"])).is_file()
]
DATASETS = {
    name: {
        **entry,
        "measured": shipped(entry["measured"]),
        "robot": shipped(entry["robot"]),
    }
    for name, entry in {**SHIPPED_DATASETS, **config["discover"]["datasets"]}.items()
}


def of_chosen_datasets(pattern):
    """An input function: files of the data sets of the configuration, or of the example where it names none."""

    def files(wildcards):
        chosen = list(config["discover"]["datasets"])
        if not chosen:
            tell_of_example("discover.datasets", "data set", SHOWN_DATASET)
        return expand(pattern, dataset=chosen or [SHOWN_DATASET])

    return files


def dataset_entry(wildcards):
    """The entry of a data set in the config."""
    return dict(DATASETS[wildcards.dataset])


def dataset_measured(wildcards):
    """Measured file of a data set, or the files of a bag's folder: the time of a folder does not tell of its files."""
    return log_sources(DATASETS[wildcards.dataset]["measured"])


def dataset_robot(wildcards):
    """Robot file of a data set; that of another data set of the config is made first."""
    return DATASETS[wildcards.dataset]["robot"]


def dataset_model(wildcards):
    """All files that the robot of a data set is made of; one that discovery writes stands for its URDF."""
    robot = DATASETS[wildcards.dataset]["robot"]
    return [robot] if written_for(robot) in DATASETS else robot_sources(robot)


def published_values(wildcards):
    """What others found on the robot of a registered data set, if that is known."""
    name = Path(DATASETS[wildcards.dataset]["measured"]).parent.name
    path = Path(shipped(f"data/published/{name}.yaml"))
    return [str(path)] if path.exists() else []
