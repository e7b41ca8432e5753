"""HTTP and WebSockets below the API: connections, requests, the checks of their texts and the form of errors."""
