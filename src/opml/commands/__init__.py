"""Subcommands of `opml`: their arguments, and what each runs and prints."""
