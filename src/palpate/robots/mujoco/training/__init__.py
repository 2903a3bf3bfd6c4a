"""Training the models that ship with the bench, and telling how good they are on what they have not met."""
