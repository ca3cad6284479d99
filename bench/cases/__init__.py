"""The problems: each module has `trials(short)`, which makes its trials one at a time, answers checked, smallest first."""
