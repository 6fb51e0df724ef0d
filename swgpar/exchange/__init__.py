"""Files of other programs: STEP, DXF, VTKHDF, tables."""
