# The hidden-effect test. Data sets, truth and verdicts lie in folders of their own; only score_challenge reads truth.
from jointwear.studies.challenge.tiers import SEED, SETS, TIERS

CHALLENGE_ROBOT = shipped("config/robots/puma560.yaml")
CHALLENGE_ROBOTS = [
    CHALLENGE_ROBOT,
    *map(str, shipped_glob("data/arms/*.yaml")),
]
CHALLENGE_TEMPLATES = templates("challenge.html.j2")


wildcard_constraints:
    seed_set="|".join(SETS),
    # A seed set, or its first batches: report_first_8 has eight batches of every tier.
    part=f"({'|'.join(SETS)})(_first_[0-9]+)?",
    tier="|".join(TIERS),
    batch="[0-9]{3}",
    world_set="|".join(world_plan.SETS),
    world_part=f"({'|'.join(world_plan.SETS)})(_first_[0-9]+)?",


rule generate_challenge:
    input:
        robots=CHALLENGE_ROBOTS,
        modules=modules_of("generate_challenge"),
    output:
        data=temp(directory("results/challenge/{seed_set}/data/{tier}_{batch}")),
        facts="results/challenge/{seed_set}/truth/{tier}_{batch}.json",
        torque="results/challenge/{seed_set}/truth/{tier}_{batch}.nc",
    log:
        "results/logs/generate_challenge/{seed_set}_{tier}_{batch}.log",
    params:
        seed=SEED,
    script:
        "../scripts/generate_challenge.py"


rule solve_challenge:
    input:
        data="results/challenge/{seed_set}/data/{tier}_{batch}",
        robots=CHALLENGE_ROBOTS,
        modules=modules_of("solve_challenge"),
    output:
        verdicts="results/challenge/{seed_set}/verdicts/{tier}_{batch}.json",
        torque="results/challenge/{seed_set}/verdicts/{tier}_{batch}.nc",
    log:
        "results/logs/solve_challenge/{seed_set}_{tier}_{batch}.log",
    # Data sets are deleted when they have been solved: solving comes before making more.
    priority: 10
    script:
        "../scripts/solve_challenge.py"


rule score_challenge:
    input:
        facts=challenge_files("truth", "json"),
        truth_torque=challenge_files("truth", "nc"),
        verdicts=challenge_files("verdicts", "json"),
        verdict_torque=challenge_files("verdicts", "nc"),
        modules=modules_of("score_challenge"),
    output:
        rows="results/challenge/{part}/cases.json",
        scores="results/challenge/{part}/scores.json",
    log:
        "results/logs/score_challenge/{part}.log",
    script:
        "../scripts/score_challenge.py"


rule report_challenge:
    input:
        scores="results/challenge/{part}/scores.json",
        templates=CHALLENGE_TEMPLATES,
        modules=modules_of("report_challenge"),
    output:
        "results/challenge/{part}/challenge.html",
    log:
        "results/logs/report_challenge/{part}.log",
    params:
        seed=SEED,
    script:
        "../scripts/report_challenge.py"


# The peers pin an older numpy than the rest of the project and have an environment of their own
# (requirements/peers.in); they are timed apart.
PEERS_CHOOSE_ON = ["000"]
PEERS_PYTHON = os.environ.get("JOINTWEAR_PEERS_PYTHON", sys.executable)


rule solve_challenge_peers:
    input:
        data="results/challenge/{seed_set}/data/{tier}_{batch}",
        robots=CHALLENGE_ROBOTS,
        modules=modules_of("solve_challenge_peers"),
    output:
        "results/challenge/{seed_set}/peers/{tier}_{batch}.json",
    log:
        "results/logs/solve_challenge_peers/{seed_set}_{tier}_{batch}.log",
    priority: 10
    params:
        python=PEERS_PYTHON,
        program=str(LIBRARY / "scripts/solve_challenge_peers.py"),
    shell:
        "{params.python} {params.program} {input.data} {output} 2> {log} || (cat {log} >&2; exit 1)"


rule score_challenge_peers:
    input:
        chosen_facts=expand(
            "results/challenge/choose/truth/{tier}_{batch}.json",
            tier=TIERS,
            batch=PEERS_CHOOSE_ON,
        ),
        chosen=expand(
            "results/challenge/choose/peers/{tier}_{batch}.json",
            tier=TIERS,
            batch=PEERS_CHOOSE_ON,
        ),
        facts=challenge_files("truth", "json"),
        answers=challenge_files("peers", "json"),
        rows="results/challenge/{part}/cases.json",
        modules=modules_of("score_challenge_peers"),
    output:
        "results/challenge/{part}/peers.json",
    log:
        "results/logs/score_challenge_peers/{part}.log",
    script:
        "../scripts/score_challenge_peers.py"


rule report_challenge_peers:
    input:
        scores="results/challenge/{part}/scores.json",
        peers="results/challenge/{part}/peers.json",
        templates=CHALLENGE_TEMPLATES,
        modules=modules_of("report_challenge"),
    output:
        "results/challenge/{part}/challenge_with_peers.html",
    log:
        "results/logs/report_challenge_peers/{part}.log",
    params:
        seed=SEED,
    script:
        "../scripts/report_challenge.py"


# The small summary that is kept with the project, so that a reader sees the scores without running the cases.
rule store_challenge:
    input:
        scores="results/challenge/{part}/scores.json",
        modules=modules_of("store_challenge"),
    output:
        "results/challenge/{part}/stored.json",
    log:
        "results/logs/store_challenge/{part}.log",
    params:
        seed=SEED,
    script:
        "../scripts/store_challenge.py"


# Declares no output in bench: the page of what is stored must never wait for an hour of cases.
rule keep_challenge:
    input:
        scores="results/challenge/{part}/stored.json",
        peers=peers_to_keep,
        place=checkout_alone("keep_challenge", "stores scores in the checkout"),
    output:
        "results/challenge/{part}/kept.txt",
    log:
        "results/logs/keep_challenge/{part}.log",
    shell:
        "cp {input.scores} data/benchmarks/challenge.json && cp {input.peers} data/benchmarks/challenge_peers.json"
        " && sha256sum {input} > {output} 2> {log}"


rule report_stored_challenge:
    input:
        scores=shipped("data/benchmarks/challenge.json"),
        peers=STORED_PEERS,
        world=STORED_WORLD,
        limits=STORED_LIMITS,
        templates=CHALLENGE_TEMPLATES,
        modules=modules_of("report_stored_challenge"),
    output:
        "results/challenge/stored/challenge.html",
    log:
        "results/logs/report_stored_challenge.log",
    script:
        "../scripts/report_stored_challenge.py"


# The tier "world": plants in MuJoCo, made and answered in one job. Needs requirements/plants.txt (make plants).
rule answer_world:
    input:
        modules=modules_of("answer_world"),
    output:
        "results/challenge/world/{world_set}/rows/{batch}.json",
    log:
        "results/logs/answer_world/{world_set}_{batch}.log",
    script:
        "../scripts/answer_world.py"


rule score_world:
    input:
        rows=world_files,
        modules=modules_of("score_world"),
    output:
        rows="results/challenge/world/{world_part}/cases.json",
        scores="results/challenge/world/{world_part}/scores.json",
    log:
        "results/logs/score_world/{world_part}.log",
    script:
        "../scripts/score_world.py"


rule keep_world:
    input:
        scores="results/challenge/world/{world_part}/scores.json",
        place=checkout_alone("keep_world", "stores scores in the checkout"),
    output:
        "results/challenge/world/{world_part}/kept.txt",
    log:
        "results/logs/keep_world/{world_part}.log",
    shell:
        "cp {input} data/benchmarks/challenge_world.json && sha256sum {input} > {output} 2> {log}"


rule make_hidden_example:
    input:
        robot=CHALLENGE_ROBOT,
        modules=modules_of("make_hidden_example"),
    output:
        "results/examples/puma560_hidden.nc",
    log:
        "results/logs/make_hidden_example.log",
    script:
        "../scripts/make_hidden_example.py"


# A task of the paper repeated for five days: one axis wears while its oil follows the day.
rule make_warm_task:
    input:
        robot=CHALLENGE_ROBOT,
        task=task_file,
        modules=modules_of("make_warm_task"),
    output:
        "results/examples/warm_{task}.nc",
    log:
        "results/logs/make_warm_task/{task}.log",
    params:
        seed=SEED,
        settings={
            "every": 8.0,
            "interval": 0.2,
            "wear_percent": 8.0,
            "wear_shape": 1.5,
            "wear_hours": 120.0,
        },
    script:
        "../scripts/make_warm_task.py"


rule challenge_peers:
    input:
        "results/challenge/report/challenge_with_peers.html",


rule challenge:
    input:
        "results/challenge/sample/challenge.html",
        "results/challenge/stored/challenge.html",


rule challenge_full:
    input:
        "results/challenge/report/challenge.html",


rule challenge_world:
    input:
        "results/challenge/world/report/scores.json",
