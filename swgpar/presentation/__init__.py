"""What a person sees of a drive: figures, report, terminal, view."""
