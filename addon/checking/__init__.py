"""What is wrong with a scene: what, where, how bad, and what would mend it."""
