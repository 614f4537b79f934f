"""Motion-capture files in and out."""
