"""A thin gap between tissues that cross or touch, opened by moving vertices as little as possible (thesis 4.1)."""
