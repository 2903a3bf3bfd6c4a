"""Selection: objectives, policies and stopping rules."""
