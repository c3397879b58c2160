"""Sound files of the environment's data."""

from opml.environment import gravity_field, solar_activity

BULLETIN = """  ESTIMATES OF 13-MONTH SMOOTH SOLAR ACTIVITY

 2016.5837   AUG    90.0      84.0      78.0      13.0      11.5      10.1
 2016.6670   SEP    92.0      85.0      79.0      13.0      11.5      10.1
 2016.7503   OCT    91.0      84.0      78.0      12.0      11.0      10.0
 2016.8337   NOV   104.0      90.5      77.0      16.0      12.0       8.0
 2016.9170   DEC   104.0      90.5      77.0      16.0      12.0       8.0
"""


def sound_files():
    """Return the bytes of a sound file of each kind."""
    return {
        "gravity": gravity_field.resolve("EGM2008").read_bytes(),
        "activity": BULLETIN.encode(),
        "weather": solar_activity.resolve("OBSERVED").read_bytes(),
    }
