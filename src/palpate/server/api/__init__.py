"""The service for programs: one module for each kind of thing."""
