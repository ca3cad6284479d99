"""Peers that solve the same problems, each written as well as its kind allows; none of them imports comminute."""
