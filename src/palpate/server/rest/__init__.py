"""The addresses of the program that this one replaces, so that scripts that upload to it go on working."""
