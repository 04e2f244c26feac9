"""The sub-commands of the command line, one file each.

What a command needs of the library is imported when it runs, so that ``--help`` answers at once.
"""
