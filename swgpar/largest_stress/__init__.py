"""The largest stresses of bodies: places, and finer meshes that resolve them."""
