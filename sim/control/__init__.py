"""The controller: plans, tracking, admittance, phases; one tick from plant state to joint rates."""
