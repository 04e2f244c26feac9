"""Methods of assessment by name, one file each."""
