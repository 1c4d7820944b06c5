"""What stands in materials and files: node groups, their sockets and wiring, tables."""
