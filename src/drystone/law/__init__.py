"""What a joint carries: its law, strengths and bonds, and the certificate of a state."""
