# What only a call as a whole shows, asked once every rule is known: jobs of their own do not ask again.
from jointwear.running.named_effects import check_named_effects, robot_files

if workflow.is_main_process:
    try:
        check_named_effects(robot_files(config))
    except InputError as error:
        sys.exit(told(error))
