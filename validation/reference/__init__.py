"""Programs that make the tables under tests/reference of what others computed or published."""
