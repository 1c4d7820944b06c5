"""The dielectric in Cycles' own nodes, a module for each of its parts."""
