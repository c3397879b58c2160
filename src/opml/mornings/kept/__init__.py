"""Folders in which mornings leave their records to those to come."""
