"""Exact curves of teeth and cams with signed distance, normal and curvature; micro-geometry."""
