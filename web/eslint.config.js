import eslint from "@eslint/js";
import reactHooks from "eslint-plugin-react-hooks";
import { defineConfig, globalIgnores } from "eslint/config";
import tseslint from "typescript-eslint";

const NEVER_HTML = {
  selector: "JSXAttribute[name.name='dangerouslySetInnerHTML']",
  message: "the service's words are text, never HTML",
};

/** The console may lie under a path of another site: src/api/address.ts. (\u002f is a slash, which ends a pattern here.) */
const PATHS_OF_THE_SERVICE = ["Literal[value=/^\\u002f[a-z]/]", "TemplateLiteral[quasis.0.value.raw=/^\\u002f[a-z]/]"].map(
  (path) => ({
    selector:
      `CallExpression[callee.name!=/^(addressOf|socketAddress|sceneAddress)$/][callee.object.name!='client'] > ${path}, ` +
      `:not(CallExpression):not(TSLiteralType) > ${path}`,
    message: "a path of the service goes through addressOf() or socketAddress()",
  }),
);

export default defineConfig(
  globalIgnores(["node_modules", "src/client", "eslint.config.js"]),
  eslint.configs.recommended,
  tseslint.configs.strictTypeChecked,
  tseslint.configs.stylisticTypeChecked,
  reactHooks.configs.flat["recommended-latest"],
  {
    languageOptions: { parserOptions: { projectService: true, tsconfigRootDir: import.meta.dirname } },
    rules: {
      "@typescript-eslint/restrict-template-expressions": ["error", { allowNumber: true }],
      "@typescript-eslint/dot-notation": "off",
      "max-lines-per-function": ["error", { max: 90, skipBlankLines: true, skipComments: true }],
      "no-restricted-syntax": [
        "error",
        NEVER_HTML,
      ],
      eqeqeq: ["error", "always"],
    },
  },
  { files: ["src/**"], rules: { "no-restricted-syntax": ["error", NEVER_HTML, ...PATHS_OF_THE_SERVICE] } },
);
