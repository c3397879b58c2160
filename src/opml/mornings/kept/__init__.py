"""What mornings leave on disk for those to come."""
