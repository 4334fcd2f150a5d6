"""Write the static site."""

from jointwear.publishing.site.edits import EDITS
from jointwear.publishing.site.writing import write_site
from jointwear.running.script import reported

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_site(snakemake.output[0], edits=EDITS, wanted=[snakemake.input.page])
