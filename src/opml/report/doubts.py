"""Slips and doubts in the paper, and how each is read here. The report on the reproduction ends with them."""

DOUBTS = (
    (
        "The table of stations gives maximum ranges as 13210, 4910 and 6380 m.",
        "Kilometres: a station that reaches 13 km sees no satellite.",
    ),
    (
        "Tukey's fences run from q1 - 3 IQR to q1 + 3 IQR.",
        "To q3 + 3 IQR, as in Tukey's test; as printed, the upper fence would lie one IQR lower.",
    ),
    (
        "Whether the fences, which need the true error, cut the rows of a future test too is not told; 'from "
        "around 50 km' at seven days, in words, is more than rows inside them have.",
        "The fences of days 0-30 cut every test, as all rows are cleaned before. Tests without fences are in "
        "the table of readings, and the sentence on kilometres is checked on one.",
    ),
    (
        "The learning variables are standardised by their mean and deviation; of which rows is not told.",
        "Of the rows trained on. A test that is standardised by itself is in the table of readings, one that "
        "is standardised together with the training in the scan.",
    ),
    (
        "The prediction duration, a learning variable, is t_i - t_b.",
        "t_j - t_i. With t_i - t_b one row could not tell the target at one track from that at the next, "
        "and every figure's axis is t_j - t_i.",
    ),
    (
        "The ISS orbit has an eccentricity of 0.006793, ten times its usual value.",
        "Kept as printed. It sets the perigee, and with it the drag.",
    ),
    (
        "A smaller semi-major axis means re-entry in less than 40 days, so only larger ones are tested.",
        "Here only a decrease by about 30 km or more does that. The experiments are the paper's.",
    ),
    (
        "The true anomaly and the mean anomaly share a symbol in the table of RSOs.",
        "Mean anomaly, as the row is named.",
    ),
    (
        "The text lists the estimated drag coefficient and its change among the learning variables, the "
        "formula omits them.",
        "Learned from. The effect of leaving them out stands in the table of readings.",
    ),
    (
        "t_b is 'the previous estimation'; what becomes of rows whose previous estimate was cleaned away "
        "is not told.",
        "The previous estimate that survives the drag coefficient's bounds. The other reading is in the "
        "table.",
    ),
    (
        "A window such as 30-40 days could count predictions by their end t_j, or by their start t_i too.",
        "By t_j, as the text's example of a prediction from day 33 to day 40 has it. The other reading is "
        "in the table.",
    ),
    (
        "The kernel scale comes from fitrsvm's heuristic, which is not public.",
        "kernlab's sigest, the public rule nearest to it. Other rules and fixed scales are in the tables.",
    ),
    (
        "Random splits test on rows whose estimate also lent rows to the training; such rows share all "
        "learning variables but the duration.",
        "As in the paper. Splits that keep an estimate's rows together are in the table of readings.",
    ),
    (
        "The figure of velocity errors has no dominant component.",
        "The radial one dominates: an RSO that is ahead by e_y flies in a direction turned by e_y / a, so "
        "that e_vx = -n e_y, with n the mean motion.",
    ),
    (
        "EIGEN-6S, DE430 and Orekit are the paper's field, ephemeris and propagator.",
        "EGM2008, DE440 and this package, as they install without a download; settings take the paper's "
        "files.",
    ),
    (
        "Orekit's measurements include the signal's travel time.",
        "Geometric, in the simulated measurements and in the estimation alike. Fits that reckon with light "
        "time are in the scan.",
    ),
)
