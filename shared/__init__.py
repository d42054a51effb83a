"""The contract between the services, its transport, and modules that all services use. It imports no other package of ours."""
