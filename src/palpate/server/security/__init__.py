"""Who may do what, and limits of what is sent."""
