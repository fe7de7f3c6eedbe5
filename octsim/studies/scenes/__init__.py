"""What a membrane, myelin, neighbours, a tilt and a cover glass do to the phase slope."""
