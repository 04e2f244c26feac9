"""Cases that show what the program is worth: closed forms, other programs, laboratory tests."""
