"""Methods: how a target is captured, each a value that the configuration names (`sim.method.registry`)."""
