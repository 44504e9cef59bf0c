"""`flatrig train`: residual policies with stable-baselines3."""
