"""Where entries come from: each module reads one kind of package as it is installed."""
