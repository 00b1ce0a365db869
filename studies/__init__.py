"""Questions: sweeps, tables, plots, the command line."""
