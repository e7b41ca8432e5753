"""The paper: its study and tables, what is flown to reproduce them, and how far the flights agree."""
