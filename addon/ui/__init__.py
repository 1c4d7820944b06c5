"""What artists see: panels, menus, operators."""
