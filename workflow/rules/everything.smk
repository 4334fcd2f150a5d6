# Everything that the shipped data allow, with its page; the studies of an hour stay targets of their own
# (challenge_full, recover_validation, recover_jointly, compare_experiments, shop_floor), and verify needs a crate.
rule everything:
    input:
        rules.recover.input,
        rules.multiverse.input,
        rules.monitor_study.input,
        rules.challenge.input,
        expand(
            "results/discover/{dataset}/{file}",
            dataset=OWN_DATASETS,
            file=["verdict.json", "discover.html"],
        ),
        expand(
            "results/monitor/{monitored}/{file}",
            monitored=OWN_ROBOTS,
            file=["alarms.csv", "state.nc", "monitor.html"],
        ),
        rules.all.input,
