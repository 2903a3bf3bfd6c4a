"""The store as a web service and as pages."""
