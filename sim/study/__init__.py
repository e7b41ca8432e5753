"""Studies: many captures that differ in chosen parameters, flown by any executor, kept as one table."""
