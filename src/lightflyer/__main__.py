"""``python -m lightflyer``."""

from lightflyer.cli import main

if __name__ == "__main__":
    main()
