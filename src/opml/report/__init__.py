"""Tables to read: the settings as the paper tabulates them, and its numbers with ours."""
