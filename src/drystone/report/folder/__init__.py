"""The folder of results of one analysis: tables, pictures, files."""
