"""`flatrig train`: residuals for cranes and hands, imitated from a teacher that knows the plant."""
