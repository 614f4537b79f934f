"""The Kalman filter and smoother of constant velocity: of rotations, of numbers, and how stiff they are to be."""
