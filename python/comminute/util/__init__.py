"""Helpers of every room: errors, words, texts, files, equality, optional libraries."""
