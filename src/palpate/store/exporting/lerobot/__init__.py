"""Data sets for robot learning in the layout of LeRobot, version 3.0.

The layout is described at https://huggingface.co/docs/lerobot/lerobot-dataset-v3.
"""
