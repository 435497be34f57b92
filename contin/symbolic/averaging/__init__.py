"""Averaging of weakly nonlinear oscillators: from equations of motion to the slow motion of amplitudes and phases."""
