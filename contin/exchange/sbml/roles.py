"""What determines the value of an identifier."""

RULE, RATE, REACTIONS, EVENTS, FIXED = "rule", "rate", "reactions", "events", "fixed"
