"""Reading: files to text, text to tokens, tokens to a syntax tree. Knows nothing of meaning."""
