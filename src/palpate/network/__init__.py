"""The declarative model: properties, sensor models, actions and known objects, read from TOML."""
