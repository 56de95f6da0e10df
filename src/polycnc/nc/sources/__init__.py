"""Block sources: the seam for languages inside part programs."""
