"""The service: everything of Becalm that needs a network, a disk or a browser."""
