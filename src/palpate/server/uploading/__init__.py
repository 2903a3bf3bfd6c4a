"""Uploading by a form: what came is read aside and shown, and kept when somebody says so."""
