"""`make bench`: this engine and its peers on the same body, refereed alike on the files they leave."""
