// A static web server for a folder of files.

import { createServer } from "node:http";
import { readFileSync } from "node:fs";
import { extname, join } from "node:path";

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml" };

/** Serves a folder. `change` maps a file's name and content to the content sent. Returns the address and a function to end it. */
export async function serve(folder, change = (_, content) => content) {
  const server = createServer((request, response) => {
    const { pathname } = new URL(request.url, "http://localhost");
    const path = pathname.endsWith("/") ? `${pathname}index.html` : pathname;
    try {
      const content = change(path, readFileSync(join(folder, path)));
      response.setHeader("content-type", TYPES[extname(path)] ?? "application/octet-stream");
      response.end(content);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  // The server of a failed test does not keep the process alive.
  server.unref();
  return { address: `http://127.0.0.1:${server.address().port}/`, end: () => server.close() };
}
