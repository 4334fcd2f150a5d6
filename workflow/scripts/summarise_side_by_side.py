"""Put the tables of the paper and of two experiments side by side."""

from jointwear.running.script import reported
from jointwear.studies.side_by_side.summary import write_chapter

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_chapter(dict(snakemake.params.folders), snakemake.output[0])
