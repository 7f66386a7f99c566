"""Tables, mesh, report and viewer: they read a finished survey and estimate nothing."""
