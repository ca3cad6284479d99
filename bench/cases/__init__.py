"""The problems: `trials(short)` of each module makes its trials one at a time, smallest first."""
