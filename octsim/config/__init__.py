"""What a user may set: read, checked, varied."""
