import eslint from "@eslint/js";
import reactHooks from "eslint-plugin-react-hooks";
import { defineConfig, globalIgnores } from "eslint/config";
import tseslint from "typescript-eslint";
import { ROOMS, roomsNotFor } from "./import-order.js";

const NEVER_HTML = {
  selector: "JSXAttribute[name.name='dangerouslySetInnerHTML']",
  message: "the service's words are text, never HTML",
};

const KEEPS_ESC = "the browser keeps the first Esc for itself where this is open, and Esc stops the mission: src/ui has what to use";

/** What of the browser's own opens over the page and takes the keys. */
const NEVER_BROWSERS_OWN = [
  "JSXOpeningElement[name.name=/^(select|datalist|dialog)$/]",
  "JSXAttribute[name.name='type'][value.value=/^(date|datetime-local|month|week|time|color)$/]",
  "JSXAttribute[name.name=/^(list|popover|popoverTarget)$/]",
  "MemberExpression[property.name=/^(requestFullscreen|showModal|showPicker|showPopover)$/]",
  "CallExpression[callee.name=/^(alert|confirm|prompt)$/]",
  "CallExpression[callee.object.name=/^(window|globalThis)$/][callee.property.name=/^(alert|confirm|prompt)$/]",
].map((selector) => ({ selector, message: KEEPS_ESC }));

/** Mantine's parts that open over the page: wrapped once, in src/ui, where each says what Esc does. */
const OVER_THE_PAGE = ["NativeSelect", "Select", "MultiSelect", "Autocomplete", "Combobox", "Popover", "Menu", "HoverCard", "Modal", "Drawer", "Dialog"];

/** The console may lie under a path of another site: src/api/address.ts. (\u002f is a slash, which ends a pattern here.) */
const PATHS_OF_THE_SERVICE = ["Literal[value=/^\\u002f[a-z]/]", "TemplateLiteral[quasis.0.value.raw=/^\\u002f[a-z]/]"].map(
  (path) => ({
    selector:
      `CallExpression[callee.name!=/^(addressOf|socketAddress)$/][callee.object.name!='client'] > ${path}, ` +
      `:not(CallExpression):not(TSLiteralType) > ${path}`,
    message: "a path of the service goes through addressOf() or socketAddress()",
  }),
);

/** The order of the rooms is read from import statements; what lies in the same folder is of the same room. */
const ONLY_STATIC_IMPORTS = { selector: "ImportExpression[source.value=/^[.][.]/]", message: "import the page's modules of other folders by a statement, which import-order.js can check" };

export default defineConfig(
  globalIgnores(["node_modules", "src/client", "*.js"]),
  eslint.configs.recommended,
  tseslint.configs.strictTypeChecked,
  tseslint.configs.stylisticTypeChecked,
  reactHooks.configs.flat["recommended-latest"],
  {
    languageOptions: { parserOptions: { projectService: true, tsconfigRootDir: import.meta.dirname } },
    rules: {
      "@typescript-eslint/restrict-template-expressions": ["error", { allowNumber: true }],
      "@typescript-eslint/dot-notation": "off",
      "max-lines-per-function": ["error", { max: 60, skipBlankLines: true, skipComments: true }],
      "no-restricted-syntax": [
        "error",
        NEVER_HTML,
      ],
      eqeqeq: ["error", "always"],
    },
  },
  {
    files: ["src/**"],
    rules: {
      "no-restricted-syntax": ["error", NEVER_HTML, ...NEVER_BROWSERS_OWN, ...PATHS_OF_THE_SERVICE, ONLY_STATIC_IMPORTS],
    },
  },
  {
    // What is read later than the first load; the shell may import whatever it likes anyway.
    files: ["src/shell/later.tsx"],
    rules: { "no-restricted-syntax": ["error", NEVER_HTML, ...NEVER_BROWSERS_OWN, ...PATHS_OF_THE_SERVICE] },
  },
  ...ROOMS.map((room) => ({
    files: [`src/${room}/**`],
    rules: {
      "no-restricted-imports": [
        "error",
        { paths: room === "ui" ? [] : [{ name: "@mantine/core", importNames: OVER_THE_PAGE, message: KEEPS_ESC }], patterns: roomsNotFor(room) },
      ],
    },
  })),
  {
    files: ["src/**/*.test.ts"],
    rules: { "max-lines-per-function": "off" },
  },
);
