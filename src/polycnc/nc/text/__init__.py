"""Program text: bytes to words and blocks."""
