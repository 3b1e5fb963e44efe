"""What is concealed in which machine."""
