import { defineConfig } from "vite";

// The viewer that every report carries: one script, put into the page as it is by core/reports.
export default defineConfig({
  oxc: { jsx: { runtime: "automatic", importSource: "preact" } },
  publicDir: false,
  build: {
    outDir: "../core/reports/viewer",
    emptyOutDir: true,
    target: "es2022",
    license: { fileName: "licenses.md" }, // goes into the page beside it
    modulePreload: { polyfill: false },
    chunkSizeWarningLimit: 900,
    rolldownOptions: {
      input: "src/report/main.tsx",
      output: { format: "iife", entryFileNames: "viewer.js" },
    },
  },
});
