"""The service as a process: its data folder and disk, its log, its scheduling, and the processes beside it."""
