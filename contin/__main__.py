"""`python -m contin` is the `contin` command."""

from contin.cli.main import main

if __name__ == "__main__":
    main()
