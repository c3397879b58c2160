"""From estimates to predictions, and all that is known of their errors at t_i."""
