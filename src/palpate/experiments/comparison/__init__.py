"""Methods compared in many worlds: tasks, scores, findings and their report."""
