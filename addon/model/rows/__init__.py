"""The rows of the table of parameters, a module for each part of the node."""
