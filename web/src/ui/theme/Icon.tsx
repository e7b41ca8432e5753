/** The console's few icons, drawn on a grid of 16; always beside words or with a label on their button. */
const ICONS = {
  stop: "M5.200 1.500h5.600l3.700 3.700v5.600l-3.700 3.700H5.200l-3.700-3.700V5.200z",
  play: "M4.500 2.800v10.400L13 8z",
  pause: "M5 3v10M11 3v10",
  step: "M3 3v10l7-5zM13 3v10",
  back: "M13 3v10L6 8zM3 3v10",
  check: "M2.800 8.500l3.400 3.400 7-7.600",
  cross: "M3.500 3.500l9 9M12.500 3.500l-9 9",
  bar: "M3 8h10",
  info: "M8 1.800a6.200 6.200 0 1 0 0 12.400A6.200 6.200 0 0 0 8 1.800M8 7.200v4M8 4.700v.2",
  warning: "M8 2L14.500 13.500H1.500zM8 6.300v3.400M8 11.600v.2",
  error: "M5.200 1.800h5.600l3.400 3.400v5.600l-3.400 3.400H5.200l-3.400-3.400V5.200zM8 4.800v4M8 11v.2",
  download: "M8 2v8M4.500 7L8 10.500 11.500 7M2.500 13.500h11",
  sun: "M8 5a3 3 0 1 0 0 6 3 3 0 0 0 0-6M8 1v1.500M8 13.500V15M1 8h1.500M13.500 8H15M3 3l1 1M12 12l1 1M3 13l1-1M12 4l1-1",
  moon: "M13.500 9.700A6 6 0 0 1 6.300 2.500a6 6 0 1 0 7.200 7.200z",
  help: "M8 1.800a6.200 6.200 0 1 0 0 12.400A6.200 6.200 0 0 0 8 1.800M6.200 6.300a1.900 1.900 0 1 1 2.700 1.800c-.7.3-.9.7-.9 1.300M8 11.300v.1",
  search: "M7 2.500a4.500 4.500 0 1 0 0 9 4.500 4.500 0 0 0 0-9M10.300 10.300L14 14",
  reset: "M3 3v4h4M3.300 7A5.300 5.300 0 1 1 3 9.500",
  lock: "M4 7.500h8v6H4zM5.500 7.500V5a2.500 2.500 0 0 1 5 0v2.500",
  wait: "M8 1.800a6.200 6.200 0 1 0 0 12.400A6.200 6.200 0 0 0 8 1.800M8 4.500V8l2.500 1.500",
  follow: "M2 8h9M8 4.500L11.500 8 8 11.500M14 3v10",
  detail: "M2 2h5v5H2zM9 9h5v5H9zM9.500 2.500h4M9.500 5.500h4M2.500 10h4M2.500 13h4",
  link: "M1.500 8a9 9 0 0 1 13 0M4 10.500a5.500 5.500 0 0 1 8 0M8 13.200v.1",
} as const;

export type IconName = keyof typeof ICONS;

const FILLED: readonly IconName[] = ["stop", "play"];

export function Icon({ icon, size = 14 }: { readonly icon: IconName; readonly size?: number }) {
  const fill = FILLED.includes(icon) ? "currentColor" : "none";
  return (
    <svg width={size} height={size} viewBox="0 0 16 16" aria-hidden="true" style={{ flex: "none" }}>
      <path d={ICONS[icon]} fill={fill} stroke="currentColor" strokeWidth="1.6" strokeLinecap="round" strokeLinejoin="round" />
    </svg>
  );
}

/** The icon of a severity. */
export const SEVERITY_ICON = { info: "info", warning: "warning", error: "error" } as const satisfies Record<string, IconName>;
