/** Mantine's components in the console's colours, type and density. */
import { Button, createTheme, type CSSVariablesResolver, type MantineColorsTuple } from "@mantine/core";

const calm: MantineColorsTuple = [
  "#e4fbf5", "#cbf3e9", "#9be7d4", "#6cdbc0", "#4fd1b5", "#35b79b", "#249a81", "#0b7a65", "#0a6f5c", "#054a3d",
];

/** Mantine's own dark greys, in the hue of `tokens.css`. */
const dark: MantineColorsTuple = [
  "#e9edf3", "#c3cbd6", "#a7b1bf", "#8390a1", "#3b4656", "#252d38", "#1b222c", "#141920", "#0e1116", "#0a0d11",
];

export const theme = createTheme({
  fontFamily: "var(--sans)",
  fontFamilyMonospace: "var(--mono)",
  primaryColor: "calm",
  primaryShade: { dark: 5, light: 7 },
  colors: { calm, dark },
  defaultRadius: 6,
  cursorType: "pointer",
  focusRing: "auto",
  components: {
    Button: Button.extend({
      defaultProps: { size: "xs", variant: "default" },
      // The main button of a place is calm; one that is given a colour has that colour.
      vars: (_, { variant, color }) =>
        variant === "filled" && color === undefined
          ? { root: { "--button-bg": "var(--calm-fill)", "--button-hover": "var(--calm)", "--button-color": "var(--on-calm)" } }
          : { root: {} },
    }),
    ActionIcon: { defaultProps: { size: 28, variant: "default" } },
    PasswordInput: { defaultProps: { size: "md" } },
    // A list of the browser's own, of what was typed before, would keep the first Esc to itself.
    TextInput: { defaultProps: { size: "xs", autoComplete: "off" } },
    SegmentedControl: { defaultProps: { size: "xs" } },
    Tooltip: {
      defaultProps: { withArrow: true, openDelay: 250, multiline: true, events: { hover: true, focus: true, touch: true } },
    },
  },
});

const SURFACES = {
  "--mantine-color-body": "var(--page)",
  "--mantine-color-text": "var(--text)",
  "--mantine-color-dimmed": "var(--dim)",
  "--mantine-color-placeholder": "var(--faint)",
  "--mantine-color-default": "var(--raised)",
  "--mantine-color-default-hover": "var(--line)",
  "--mantine-color-default-color": "var(--text)",
  "--mantine-color-default-border": "var(--line-strong)",
  "--mantine-color-error": "var(--error)",
};

/** Mantine's surfaces follow `tokens.css`, which alone knows about dark and light. */
export const surfaces: CSSVariablesResolver = () => ({ variables: {}, dark: SURFACES, light: SURFACES });
