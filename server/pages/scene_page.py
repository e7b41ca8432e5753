"""viser's page as the console shows it: dark from the first paint, without panels, and telling how far it is.

What is put into its head tells the page around it (`postMessage`, `{"scene": ...}`) when viser's program has arrived
(`arrived`), when it makes its canvas (`begun`) and when the first picture with robot and target has been drawn
(`drawn`). A picture that was asked for by name (`server.scene.doorway`) is given to that page, too, as PNG without a
background (`picture`, with `name` and `content`, which is empty if it could not be drawn); it goes nowhere else.
"""

from __future__ import annotations

import hashlib
from functools import lru_cache
from typing import NamedTuple

HEAD = """<script>
(() => {
  const query = new URLSearchParams(location.search);
  query.set("darkMode", "");
  if (query.has("light")) {
    // A quarter of the pixels, and the socket that leaves out what is dear to draw.
    query.set("fixedDpr", "0.5");
    query.set("websocket", location.origin.replace(/^http/, "ws") + location.pathname.replace(/[/]$/, "") + "/light");
  }
  history.replaceState(null, "", location.pathname + "?" + query);

  // viser looks for a service that is gone only while its page has the focus; within ours it hardly ever has.
  document.hasFocus = () => !document.hidden;
  document.addEventListener("visibilitychange", () => dispatchEvent(new Event("focus")));

  const tell = (scene) => parent.postMessage({ scene }, location.origin);
  tell("arrived");
  const DRAWS = ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"];
  const ENOUGH = 24; // strokes of one picture: more than floor and lights alone take
  const watch = (context) => {
    let strokes = 0;
    for (const name of DRAWS) {
      const draw = context[name];
      context[name] = function (...given) { strokes += 1; return draw.apply(this, given); };
    }
    const look = () => {
      if (strokes < ENOUGH) {
        strokes = 0;
        requestAnimationFrame(look);
        return;
      }
      for (const name of DRAWS) delete context[name];
      context.readPixels(0, 0, 1, 1, context.RGBA, context.UNSIGNED_BYTE, new Uint8Array(4)); // waits for the picture
      tell("drawn");
    };
    requestAnimationFrame(look);
  };
  // viser would send it to its server, through the worker that has its socket.
  const send = Worker.prototype.postMessage;
  Worker.prototype.postMessage = function (said, ...given) {
    if (said?.message?.type !== "GetRenderResponseMessage") return send.call(this, said, ...given);
    const { render_uuid: name, payload: content } = said.message;
    parent.postMessage({ scene: "picture", name, content }, location.origin, [content.buffer]);
  };

  const make = HTMLCanvasElement.prototype.getContext;
  let watched = false;
  HTMLCanvasElement.prototype.getContext = function (kind, ...given) {
    const context = make.call(this, kind, ...given);
    if (context !== null && !watched && kind === "webgl2" && this.isConnected) {
      watched = true;
      tell("begun");
      watch(context);
    }
    return context;
  };
})();
</script>
<style>
html, body { background: #0e1116 }
canvas[data-engine] {
  background: radial-gradient(120% 90% at 50% 40%, #151b24 0%, #0e1116 60%, #0a0c10 100%);
  /* viser holds it at 5 % until its environment map is decoded, half a minute without a graphics card. */
  opacity: 1 !important;
}
[data-floating-window], #webgl-software-rendering { display: none !important }
div:has(canvas[data-engine]) + .mantine-Paper-root { display: none !important }
</style>"""
"""What is put at the top of the page's head."""


class ScenePage(NamedTuple):
    """The page, and its mark in caches."""

    body: bytes
    etag: str


@lru_cache(maxsize=2)
def page_with_head(page: bytes) -> ScenePage:
    """That page with `HEAD` at the top of its head."""
    body = page.replace(b"<head>", b"<head>" + HEAD.encode(), 1)
    return ScenePage(body, f'"{hashlib.sha256(body).hexdigest()[:32]}"')
