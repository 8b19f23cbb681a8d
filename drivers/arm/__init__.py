"""Arms that carry the part."""
