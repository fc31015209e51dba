"""`warpgran verify`: exact solutions, orders of accuracy, properties, and the limits of the model."""
