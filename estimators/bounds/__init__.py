"""Bounds and exact statistics of interferometric delay estimates."""
