"""Windows on finer meshes that resolve the stress at the teeth."""
