"""What an analysis gives: the capacity curve and the events along it."""
