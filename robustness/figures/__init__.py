"""Pictures of results; matplotlib (the extra ``plot``) is imported when one is drawn."""
