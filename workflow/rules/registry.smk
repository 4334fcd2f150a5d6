# Data and models that others published: fetched when a target asks for them, never part of the project.
from jointwear.files.registered import FETCHED, REGISTRY, read_registry

REGISTERED = read_registry(REGISTRY)


rule fetch_data:
    input:
        [
            str(FETCHED / name / file)
            for name, entry in REGISTERED.items()
            for file in entry["files"]
        ],


for registered_name, registered_entry in REGISTERED.items():

    rule:
        name:
            f"fetch_{registered_name}"
        input:
            registry=shipped("data/registry.yaml"),
            modules=modules_of("fetch_registered"),
        output:
            [
                str(FETCHED / registered_name / file)
                for file in registered_entry["files"]
            ],
        log:
            f"results/logs/fetch_registered/{registered_name}.log",
        params:
            name=registered_name,
        script:
            "../scripts/fetch_registered.py"
