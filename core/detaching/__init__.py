"""Parts of a body that touch, such as arm and torso, set apart again (thesis 5.3)."""
