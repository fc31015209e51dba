"""Parameters fitted to measurements: screening of the prior, best fit, posterior, predictions."""
