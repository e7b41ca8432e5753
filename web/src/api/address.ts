/**
 * Where the service is: beside the page, which may lie under a path of another site (`https://lab.example/becalm/`).
 * Every path of the service that does not go through the client in `service.ts` goes through here; eslint holds it.
 */

/** The folder of the page; routes are in the hash, so it is the same on all pages. */
export const HERE = ".";

/** The address of a path of the service, such as `/scene/`. */
export const addressOf = (path: `/${string}`): string => HERE + path;

/** The address of a WebSocket of the service. */
export function socketAddress(path: `/${string}`): URL {
  const address = new URL(addressOf(path), document.baseURI);
  address.protocol = address.protocol.replace("http", "ws");
  return address;
}
