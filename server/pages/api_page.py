"""The API's own documentation at `/docs`: Swagger UI in the console's looks, from files of our own.

It works offline. Addresses are relative to this page: it may lie under a path of another site.
"""

from __future__ import annotations

PAGE = b"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Becalm API</title>
<link rel="icon" type="image/svg+xml" href="favicon.svg">
<link rel="stylesheet" href="swagger/swagger-ui.css">
<link rel="stylesheet" href="swagger/console.css">
<script>
// The theme of the console, before anything is painted; Swagger UI has its dark one by a class.
const KEY = "mantine-color-scheme-value";
const show = (theme) => {
  document.documentElement.dataset.mantineColorScheme = theme;
  document.documentElement.classList.toggle("dark-mode", theme === "dark");
};
let theme = "dark";
try { theme = localStorage.getItem(KEY) === "light" ? "light" : "dark"; } catch { /* a browser that keeps nothing */ }
show(theme);
addEventListener("DOMContentLoaded", () => {
  document.getElementById("theme").addEventListener("click", () => {
    theme = theme === "light" ? "dark" : "light";
    show(theme);
    try { localStorage.setItem(KEY, theme); } catch { /* likewise */ }
  });
});
</script>
</head>
<body>
<header class="bar">
<a class="brand" href="./"><img src="favicon.svg" alt="" width="24" height="24">Becalm</a>
<strong>API</strong>
<nav aria-label="Documentation">
<a href="./">Console</a>
<a href="help/api.html">Guide to the API</a>
<a href="openapi.json">OpenAPI document</a>
</nav>
<button type="button" id="theme">Dark or light</button>
</header>
<main id="swagger-ui"></main>
<script src="swagger/swagger-ui-bundle.js"></script>
<script>
SwaggerUIBundle({
  url: "openapi.json",
  dom_id: "#swagger-ui",
  deepLinking: true,
  filter: true,
  tryItOutEnabled: true,
  defaultModelsExpandDepth: 0,
  docExpansion: "list",
  syntaxHighlight: { theme: "nord" },
});
</script>
</body>
</html>
"""
