"""Who may do what: tokens with roles, one check for every request, and a log of what was asked and refused."""
