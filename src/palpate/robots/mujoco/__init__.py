"""A robot bench in physics: arm, gripper, camera and microphone, simulated by MuJoCo (extra ``bench``)."""
