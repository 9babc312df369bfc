"""Cases with a known answer, for `SolverSPH`: one file a case, each with a `CASE`."""
