"""What every room uses: words, files, equality."""
