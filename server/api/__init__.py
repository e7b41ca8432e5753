"""The service's face to the network: one thin file a resource, under `/api/v1`."""

PREFIX = "/api/v1"
