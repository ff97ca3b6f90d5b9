import { svelte } from '@sveltejs/vite-plugin-svelte';
import { defineConfig } from 'vite';
import { version } from './dev/version.js';

// `npm run develop` shows changes of the sources at once; the data come from a running server.
const server = process.env['TOUCHLINE_CONSOLE'] ?? 'http://127.0.0.1:8642';

export default defineConfig({
  base: './',
  plugins: [svelte()],
  define: { PAGE_VERSION: JSON.stringify(version) },
  build: { target: 'es2022', assetsInlineLimit: 0, modulePreload: { polyfill: false } },
  server: {
    host: '127.0.0.1',
    proxy: {
      '/ws': { target: server, ws: true, rewriteWsOrigin: true, changeOrigin: true },
      '/snapshot.jpg': { target: server, changeOrigin: true },
      '/bug-report': { target: server, changeOrigin: true },
      '/metrics': { target: server, changeOrigin: true },
    },
  },
});
