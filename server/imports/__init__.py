"""Logs from elsewhere as runs of the library: CSV or MCAP, whose columns or topics a small map names."""
