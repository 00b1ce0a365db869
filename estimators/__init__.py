"""Methods: arrays in, delay estimates out; windows and bounds."""
