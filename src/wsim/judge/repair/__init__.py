"""What to change so that a finding goes away."""
