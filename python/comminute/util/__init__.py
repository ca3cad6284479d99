"""Helpers that every room uses: errors, words, files, equality."""
