"""What makes the phase slope scatter, and spike."""
