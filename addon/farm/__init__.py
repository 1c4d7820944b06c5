"""Files and jobs for other machines."""
