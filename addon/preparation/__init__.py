"""Making a scene ready, keeping it so, and saying what is wrong with it."""
