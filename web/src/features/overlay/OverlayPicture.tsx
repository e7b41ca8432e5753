/** The picture of several runs: axes, curves, and the cursor that reads them. The same on the page and on paper. */
import { scaleLinear } from "d3-scale";
import { useMemo } from "react";
import { decimalsOf, fixed } from "../../units/units";
import { pathOf, type Extent, type OverlayCurve } from "./curves";

export interface Ink {
  readonly ground: string;
  readonly text: string;
  readonly grid: string;
  readonly axis: string;
}

export interface DrawnCurve extends OverlayCurve {
  readonly label: string;
  readonly colour: string;
  readonly dash: string | undefined;
}

export interface PictureProps {
  readonly curves: readonly DrawnCurve[];
  readonly extent: Extent;
  readonly size: { readonly width: number; readonly height: number };
  readonly xLabel: string;
  readonly yLabel: string;
  readonly ink: Ink;
  /** Of a figure that stands alone, with its legend. */
  readonly title?: string;
  /** The points that the cursor reads. */
  readonly read?: readonly { readonly x: number; readonly y: number; readonly colour: string }[];
  /** The stretch that is being chosen, in values of x. */
  readonly choosing?: readonly [number, number] | null;
}

const LEGEND_LINE = 16;
const LABEL = 11;

export interface Places {
  readonly left: number;
  readonly right: number;
  readonly top: number;
  readonly bottom: number;
}

/** Where the field of the curves stands. */
export function placesOf({ size, title, curves }: Pick<PictureProps, "size" | "title" | "curves">): Places {
  const head = title === undefined ? 10 : 34 + LEGEND_LINE * Math.ceil(curves.length / 2);
  return { left: 62, right: size.width - 16, top: head, bottom: size.height - 40 };
}

export function scalesOf({ extent }: Pick<PictureProps, "extent">, { left, right, top, bottom }: Places) {
  return { x: scaleLinear([...extent.x], [left, right]), y: scaleLinear([...extent.y], [bottom, top]) };
}

type Scales = ReturnType<typeof scalesOf>;

function Axes({ scales: { x, y }, places, xLabel, yLabel, ink }: { readonly scales: Scales; readonly places: Places } & Pick<PictureProps, "xLabel" | "yLabel" | "ink">) {
  const [across, up] = [x.ticks(9), y.ticks(7)];
  const [acrossDecimals, upDecimals] = [decimalsOf(across), decimalsOf(up)];
  const middle = (places.top + places.bottom) / 2;
  return (
    <g fontSize={LABEL} fill={ink.text}>
      {up.map((value) => (
        <g key={value}>
          <line x1={places.left} x2={places.right} y1={y(value)} y2={y(value)} stroke={ink.grid} />
          <text x={places.left - 7} y={y(value) + 4} textAnchor="end">{fixed(value, upDecimals)}</text>
        </g>
      ))}
      {across.map((value) => (
        <g key={value}>
          <line x1={x(value)} x2={x(value)} y1={places.top} y2={places.bottom} stroke={ink.grid} />
          <text x={x(value)} y={places.bottom + 16} textAnchor="middle">{fixed(value, acrossDecimals)}</text>
        </g>
      ))}
      <path d={`M${places.left} ${places.top}V${places.bottom}H${places.right}`} fill="none" stroke={ink.axis} />
      <text x={(places.left + places.right) / 2} y={places.bottom + 33} textAnchor="middle">{xLabel}</text>
      <text textAnchor="middle" transform={`translate(14 ${middle}) rotate(-90)`}>{yLabel}</text>
    </g>
  );
}

/** What a figure says where there is no page around it. */
function Legend({ curves, title, places, ink }: Pick<PictureProps, "curves" | "title" | "ink"> & { readonly places: Places }) {
  const column = (places.right - places.left) / 2;
  return (
    <g fontSize={LABEL} fill={ink.text}>
      <text x={places.left} y={20} fontSize={15} fontWeight="bold">{title}</text>
      {curves.map(({ run, label, colour, dash }, place) => (
        <g key={run} transform={`translate(${places.left + (place % 2) * column} ${38 + LEGEND_LINE * Math.floor(place / 2)})`}>
          <line x1={0} x2={20} stroke={colour} strokeWidth={2} strokeDasharray={dash} />
          <text x={26} y={4}>{label}</text>
        </g>
      ))}
    </g>
  );
}

export function OverlayPicture(props: PictureProps) {
  const { curves, extent, size, ink, title, read = [], choosing = null } = props;
  const places = useMemo(() => placesOf({ size, curves, ...(title !== undefined && { title }) }), [size, title, curves]);
  const scales = useMemo(() => scalesOf({ extent }, places), [extent, places]);
  const paths = useMemo(() => curves.map((curve) => ({ curve, path: pathOf(curve, scales.x, scales.y) })), [curves, scales]);
  return (
    <svg xmlns="http://www.w3.org/2000/svg" width={size.width} height={size.height} viewBox={`0 0 ${size.width} ${size.height}`} fontFamily="Helvetica, Arial, sans-serif" aria-hidden="true">
      <rect width={size.width} height={size.height} fill={ink.ground} />
      <clipPath id="overlay-field">
        <rect x={places.left} y={places.top} width={places.right - places.left} height={places.bottom - places.top} />
      </clipPath>
      <Axes scales={scales} places={places} xLabel={props.xLabel} yLabel={props.yLabel} ink={ink} />
      <g clipPath="url(#overlay-field)">
        {choosing !== null && <rect x={scales.x(Math.min(...choosing))} width={Math.abs(scales.x(choosing[1]) - scales.x(choosing[0]))} y={places.top} height={places.bottom - places.top} fill={ink.grid} />}
        {paths.map(({ curve, path }) => (
          <path key={curve.run} d={path} fill="none" stroke={curve.colour} strokeWidth={1.6} strokeLinejoin="round" strokeDasharray={curve.dash} />
        ))}
        {read.map(({ x, y, colour }) => (
          <circle key={`${colour} ${x} ${y}`} cx={scales.x(x)} cy={scales.y(y)} r={4} fill={colour} stroke={ink.ground} strokeWidth={1.5} />
        ))}
      </g>
      {title !== undefined && <Legend curves={curves} title={title} places={places} ink={ink} />}
    </svg>
  );
}
