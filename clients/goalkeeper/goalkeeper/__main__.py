"""`python -m goalkeeper`"""

from goalkeeper.app.script import script

if __name__ == "__main__":
    script()
