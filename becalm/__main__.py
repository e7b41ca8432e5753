"""`python -m becalm`: the same as the command `becalm`."""

from becalm.cli import main

if __name__ == "__main__":
    main(prog_name="becalm")
