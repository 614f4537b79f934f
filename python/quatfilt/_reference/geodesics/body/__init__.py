"""Principal geodesic analysis of whole poses: geodesics of the product of all joints' rotations."""
