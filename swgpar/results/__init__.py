"""Result files: history, fields, checkpoint, summary."""
