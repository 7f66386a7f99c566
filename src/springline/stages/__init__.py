"""The stages of an inspection: each a function from Survey to Survey that adds its group."""
