"""Files of laser ranges: two normal points of a station in the first hour of a run, and where it is."""

LASER = {
    "lageos.crd": """\
H1 CRD 1 2016 9 28 14
H2 YARL 7090 5 13 3
H3 lageos1 7603901 1155 8820 0 1
H4 1 2016 9 28 13 0 0 2016 9 28 13 20 0 0 0 0 0 1 0 2 0
C0 0 532.000 std
20 46800.0 983.7 301.4 24.0 0
11 46810.2 0.0392 std 2 120.0 94
11 46930.2 0.0391 std 2 120.0 94
H8
H9
""",
    "coordinates.snx": """\
%=SNX 2.01
+SOLUTION/EPOCHS
 7090 A 1 C 83:011:58876 00:000:00000 99:007:13417
-SOLUTION/EPOCHS
+SOLUTION/ESTIMATE
 1 STAX 7090 A 1 10:001:00000 m 2 -2389006.436 0.005
 2 STAY 7090 A 1 10:001:00000 m 2 5043329.354 0.003
 3 STAZ 7090 A 1 10:001:00000 m 2 -3078524.145 0.005
 4 VELX 7090 A 1 10:001:00000 m/y 2 -0.048 0.0001
 5 VELY 7090 A 1 10:001:00000 m/y 2 0.009 0.0001
 6 VELZ 7090 A 1 10:001:00000 m/y 2 0.051 0.0001
-SOLUTION/ESTIMATE
""",
    "eccentricities.snx": """\
%=SNX 2.02
+SITE/ECCENTRICITY
 7090  A    1 L 14:080:00000 00:000:00000 UNE   3.1827  -0.0064   0.0194        70900513
-SITE/ECCENTRICITY
""",
}
"""Their texts by name."""


RANGING = {name: f"{name}.snx" for name in ("coordinates", "eccentricities")} | {"reflectors_m": 0.25}
"""How they are taken."""


def write(folder):
    """Write the files."""
    for name, text in LASER.items():
        (folder / name).write_text(text)
