"""Stage → Newton model of one or many worlds → stepped → recorded."""
