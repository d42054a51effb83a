"""The contract between the services: messages, topics, codec, bus and clock."""
