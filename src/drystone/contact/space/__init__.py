"""Contacts of solids: narrow phase, gradients of gap and slips."""
