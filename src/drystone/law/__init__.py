"""The joint law: reactions, strengths and bonds; and the certificate of a state."""
