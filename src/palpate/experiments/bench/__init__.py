"""The known objects on the bench in physics, with sensors calibrated on the others."""
