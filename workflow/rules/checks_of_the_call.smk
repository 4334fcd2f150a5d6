# What only a call as a whole shows, asked once every rule is known: jobs of their own do not ask again, and another
# workflow that takes this one as a module has rules of its own.
from snakemake.io import strip_wildcard_constraints

from jointwear.running.named_effects import check_named_effects, robot_files
from jointwear.running.targets import asked_for, check_targets

if workflow.is_main_process and Path(workflow.main_snakefile).resolve() == OURS:
    try:
        check_targets(
            asked_for(),
            [r.name for r in workflow.rules if not r.has_wildcards()],
            lambda target: any(r.is_producer(target) for r in workflow.rules),
            (
                strip_wildcard_constraints(str(file))
                for r in workflow.rules
                for file in r.output
            ),
        )
        check_named_effects(robot_files(config))
    except InputError as error:
        sys.exit(told(error))
