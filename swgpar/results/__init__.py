"""Results: history, fields, checkpoint and figures; in a results folder, or in memory."""
