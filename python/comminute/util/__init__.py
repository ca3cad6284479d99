"""Helpers of every room: words, texts, files, equality, optional libraries."""
