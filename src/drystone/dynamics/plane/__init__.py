"""Dynamics in the plane: contacts and motion of explicit cycles."""
