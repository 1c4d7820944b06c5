"""What surrounds the media of a scene, and where that is kept."""
