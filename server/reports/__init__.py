"""Reports of runs, studies and fits: what is said once, written as a page and as PDF."""
