"""What is analysed: blocks, joints, supports, loads, ties, settlements; generators and checks."""
