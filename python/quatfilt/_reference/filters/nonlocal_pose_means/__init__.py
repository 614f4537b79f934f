"""Non-local pose means: each pose becomes the mean of the poses whose surroundings look like its own.

C. J. Dean and J. P. Lewis, *Non-local Pose Means for Denoising Motion Capture Data*, 2017.
"""
