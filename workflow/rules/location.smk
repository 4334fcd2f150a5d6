LOCATION_READING = reading_of(config, "location")


# Only one reading asks for the onset; with the others an edit of the detection leaves the location alone.
rule locate_wear:
    input:
        **(
            {"detection": "results/detection/{task}/{run}.nc"}
            if LOCATION_READING["correlated_hours"] == "until_onset"
            else {}
        ),
        features="results/features/{task}/{run}.nc",
        training="results/features/{task}/training.nc",
        modules=modules_of("locate_wear"),
    output:
        "results/location/{task}/{run}.nc",
    log:
        "results/logs/locate_wear/{task}_{run}.log",
    params:
        settings={"reading": LOCATION_READING},
    script:
        "../scripts/locate_wear.py"
