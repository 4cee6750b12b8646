"""What is true without any web service: geometry and its vocabulary."""
