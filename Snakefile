# The workflow itself is workflow/Snakefile; this one lets `snakemake` run from the project's root and owns the
# default target, which an included file does not hand on.


include: "workflow/Snakefile"


rule default:
    default_target: True
    input:
        rules.all.input,
    message:
        "Every figure and table that the study asks for"
