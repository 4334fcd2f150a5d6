# The files of a seed set of the hidden-effect test, or of its first batches.
from jointwear.studies.challenge.plan import part_batches
from jointwear.studies.challenge.tiers import SEED, SETS, TIERS
from jointwear.studies.world import plan as world_plan


def challenge_files(folder, ending):
    """All files of one folder of a seed set, or of its first batches, in the order of the batches."""

    def files(wildcards):
        seed_set, counts = part_batches(wildcards.part)
        return [
            f"results/challenge/{seed_set}/{folder}/{tier}_{k:03d}.{ending}"
            for tier in TIERS
            for k in range(counts[tier])
        ]

    return files


def world_files(wildcards):
    """Judged answers to the tier "world" of a seed set, or of its first batches."""
    seed_set, count = world_plan.part_batches(wildcards.world_part)
    return [
        f"results/challenge/world/{seed_set}/rows/{k:03d}.json" for k in range(count)
    ]


# The other methods run on these first batches of every tier: they are slower than what they are compared with.
PEER_BATCHES = 1


def peers_to_keep(wildcards):
    """Scores of the other methods on the first batches of a seed set."""
    seed_set, _ = part_batches(wildcards.part)
    return f"results/challenge/{seed_set}_first_{PEER_BATCHES}/peers.json"


# Results of the other methods, where they are kept with the project.
STORED_PEERS = [
    str(path) for path in shipped_glob("data/benchmarks/challenge_peers.json")
]

# Results of the tier "world", where they are kept with the project.
STORED_WORLD = [
    str(path) for path in shipped_glob("data/benchmarks/challenge_world.json")
]

# What moving the limits of discovery does, where it is kept with the project.
STORED_LIMITS = [
    str(path) for path in shipped_glob("data/benchmarks/discovery_limits.json")
]
