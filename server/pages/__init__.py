"""What browsers load: the built console, and the pages of the scenes."""
