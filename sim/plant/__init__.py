"""Plants: what takes joint rates and gives back the state of robot and target."""
