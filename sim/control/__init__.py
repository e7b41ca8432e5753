"""The controller's tools: plans, tracking, admittance, phases, and hand motion to joint rates."""
