/** Parts of the console that are read when they are first shown: what an operator needs at once comes first, and alone. */
import { lazy, Suspense, useState, type ReactNode } from "react";

const READ = {
  library: async () => ({ default: (await import("../features/library/LibraryPage")).LibraryPage }),
  overlay: async () => ({ default: (await import("../features/overlay/OverlayPage")).OverlayPage }),
  studies: async () => ({ default: (await import("../features/studies/StudiesPage")).StudiesPage }),
  atlas: async () => ({ default: (await import("../features/atlas/AtlasPage")).AtlasPage }),
  alarms: async () => ({ default: (await import("../features/alarms/AlarmsPage")).AlarmsPage }),
  link: async () => ({ default: (await import("../features/link/LinkPage")).LinkPage }),
  palette: async () => ({ default: (await import("./palette/Palette")).Palette }),
  tour: async () => ({ default: (await import("./tour/Tour")).Tour }),
  wall: async () => ({ default: (await import("../features/mission/WallView")).WallView }),
  signIn: async () => ({ default: (await import("../features/access/SignIn")).SignIn }),
};

export const LibraryPage = lazy(READ.library);
export const OverlayPage = lazy(READ.overlay);
export const StudiesPage = lazy(READ.studies);
export const AtlasPage = lazy(READ.atlas);
export const AlarmsPage = lazy(READ.alarms);
export const LinkPage = lazy(READ.link);
export const Palette = lazy(READ.palette);
export const Tour = lazy(READ.tour);
export const WallView = lazy(READ.wall);
export const SignIn = lazy(READ.signIn);

/** What draws figures for a paper, and makes files of them. */
const readFigures = (): Promise<unknown> => Promise.all([import("../features/plots/figure-of"), import("../ui/export/figure-file")]);

/** Milliseconds after which what may be needed is read, too: every page is there then, also when the service is not. */
const AHEAD = 4000;

/** For an effect: reads everything once nobody waits for anything any more. */
export function readAhead(): () => void {
  const timer = setTimeout(() => {
    // Whoever opens what could not be read is told then.
    for (const read of [...Object.values(READ), readFigures]) read().catch(() => undefined);
  }, AHEAD);
  return () => {
    clearTimeout(timer);
  };
}

/** Nothing before it was shown once; from then on it stays, as it was, while something else is shown. */
export function Later({ shown, children }: { readonly shown: boolean; readonly children: ReactNode }) {
  const [wanted, setWanted] = useState(shown);
  if (shown && !wanted) setWanted(true);
  return wanted ? <Suspense fallback={shown ? <main><p role="status">Loading.</p></main> : null}>{children}</Suspense> : null;
}
