"""The orbit inside a public element set: sought, judged by later sets, predicted, and where it was."""
