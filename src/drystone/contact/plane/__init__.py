"""Contacts of outlines: narrow phase, gradients of gap and slip."""
