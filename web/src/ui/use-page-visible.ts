/** Whether anybody can see this page: a tab in the background asks for nothing and draws nothing. */
import { useSyncExternalStore } from "react";

function subscribe(listener: () => void): () => void {
  document.addEventListener("visibilitychange", listener);
  return () => {
    document.removeEventListener("visibilitychange", listener);
  };
}

const visible = (): boolean => document.visibilityState === "visible";

export const usePageVisible = (): boolean => useSyncExternalStore(subscribe, visible);
