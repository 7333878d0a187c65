// `glint-bench view` and `train --view` as children of the test.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { request } from "node:http";

// {address, ended, stop()}: ended is a promise of the exit code; stop() sends Ctrl-C and checks how
// the server ends.
export async function startServer(bench, verb) {
  const server = spawn(bench, [...verb, "--no-browser"], { stdio: ["ignore", "pipe", "pipe"] });
  const ended = new Promise((done) => server.once("exit", (code, signal) => done(code ?? signal)));
  const address = await new Promise((done, fail) => {
    let text = "";
    const listen = (data) => {
      text += data;
      const found = text.match(/http:\/\/\S+/);
      if (found) done(found[0]);
    };
    server.stdout.on("data", listen);
    server.stderr.on("data", listen);
    ended.then((code) => fail(new Error(`glint-bench ${verb[0]} ended with ${code}: ${text}`)));
  });
  const stop = async () => {
    server.kill("SIGINT");
    assert.ok([0, 130].includes(await ended), "Ctrl-C ends it");
  };
  return { address, ended, stop };
}

// The status of a WebSocket's first request: 101, or why there is none.
export function socketStatus(address, path, headers = {}) {
  const { hostname, port } = new URL(address);
  return new Promise((done, fail) => {
    const call = request({
      ...{ hostname, port, path },
      headers: {
        Connection: "Upgrade",
        Upgrade: "websocket",
        "Sec-WebSocket-Version": "13",
        "Sec-WebSocket-Key": Buffer.alloc(16, 7).toString("base64"),
        ...headers,
      },
    });
    call.on("response", (response) => done(response.statusCode));
    call.on("upgrade", (response, socket) => {
      socket.destroy();
      done(response.statusCode);
    });
    call.on("error", fail);
    call.end();
  });
}
