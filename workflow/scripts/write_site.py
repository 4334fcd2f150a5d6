"""Write the static site."""

from jointwear.script import reported
from jointwear.site.edits import EDITS
from jointwear.site.writing import write_site

if __name__ == "__main__":
    with reported(snakemake.log[0]):
        write_site(snakemake.output[0], edits=EDITS)
