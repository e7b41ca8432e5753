"""The report of `becalm reproduce`: figures, tables and one page that needs nothing else."""
