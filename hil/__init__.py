"""The composition root: cell, commands, log, summary and report."""
