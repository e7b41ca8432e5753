/** An atlas and its cells, asked for again while it is flown: only what came since. */
import { skipToken, useQuery, useQueryClient } from "@tanstack/react-query";
import { refusalIn } from "../../api/query-client";
import type { Refusal } from "../../api/refusal";
import { readAtlas } from "../../api/service";
import type { AtlasCell, AtlasDetail } from "../../api/types";
import { numberOf } from "./as-map";

/** Milliseconds between two looks: a map that fills should be seen to fill. */
const LIVE_PERIOD = 300;
const RETRY_PERIOD = 2000;

export const isUnderWay = ({ status }: AtlasDetail): boolean => status === "queued" || status === "running";

type Cells = ReadonlyMap<number, AtlasCell>;

interface Known {
  readonly atlas: AtlasDetail;
  readonly cells: Cells;
}

export interface AtlasView {
  readonly atlas: AtlasDetail | null;
  /** By the number of `numberOf`. */
  readonly cells: Cells;
  readonly refusal: Refusal | null;
  readonly readAgain: () => Promise<unknown>;
}

const NO_CELLS: Cells = new Map();

/** @throws Refusal */
async function readFurther(id: string, known: Known | undefined): Promise<Known> {
  const atlas = await readAtlas(id, known?.atlas.revision ?? 0);
  if (known !== undefined && atlas.cells.length === 0) return { atlas, cells: known.cells };
  return { atlas, cells: new Map([...(known?.cells ?? []), ...atlas.cells.map((cell): [number, AtlasCell] => [numberOf(atlas, cell), cell])]) };
}

/** Of none with an empty identifier. */
export function useAtlas(id: string): AtlasView {
  const client = useQueryClient();
  const queryKey = ["atlas", id];
  const { data, error, refetch } = useQuery({
    queryKey,
    queryFn: id === "" ? skipToken : () => readFurther(id, client.getQueryData<Known>(queryKey)),
    structuralSharing: false,
    refetchInterval: ({ state }) => {
      const refusal = refusalIn(state.error);
      if (refusal !== null) return refusal.decided ? false : RETRY_PERIOD;
      return state.data !== undefined && isUnderWay(state.data.atlas) ? LIVE_PERIOD : false;
    },
  });
  return { atlas: data?.atlas ?? null, cells: data?.cells ?? NO_CELLS, refusal: refusalIn(error), readAgain: refetch };
}
