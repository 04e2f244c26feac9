"""Dynamics in space: contacts and motion of explicit cycles, and the interior of implicit steps."""
