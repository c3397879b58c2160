"""Pictures of the documentation: drawn, shrunk for a screen, and marked with a digest of what draws them."""
