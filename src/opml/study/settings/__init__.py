"""Settings as files laid over each other, their schema, and what is merged from them."""
