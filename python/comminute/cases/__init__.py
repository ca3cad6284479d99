"""Case files: their schema, reading and running."""
