# The files of a seed set of the hidden-effect test.
from jointwear.challenge.plan import batches
from jointwear.challenge.tiers import BATCH, COUNTS, SEED, SETS, TIERS


def challenge_batches(seed_set):
    """Batches of a seed set, as they stand in file names."""
    return [
        f"{tier}_{k:03d}"
        for tier in TIERS
        for k in range(len(batches(seed_set, tier, COUNTS[seed_set], BATCH[seed_set])))
    ]


def challenge_files(folder, ending):
    """All files of one folder of a seed set, in the order of the batches."""

    def files(wildcards):
        return [
            f"results/challenge/{wildcards.seed_set}/{folder}/{name}.{ending}"
            for name in challenge_batches(wildcards.seed_set)
        ]

    return files
