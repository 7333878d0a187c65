// `glint-bench view` as a child of the test.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { request } from "node:http";

// {address, stop()}; stop() sends Ctrl-C and checks how the server ends.
export async function startServer(bench, runs) {
  const server = spawn(bench, ["view", ...runs, "--no-browser"], {
    stdio: ["ignore", "pipe", "inherit"],
  });
  const ended = new Promise((done) => server.once("exit", (code, signal) => done(code ?? signal)));
  const address = await new Promise((done, fail) => {
    let text = "";
    server.stdout.on("data", (data) => {
      text += data;
      const found = text.match(/http:\/\/\S+/);
      if (found) done(found[0]);
    });
    ended.then((code) => fail(new Error(`glint-bench view ended with ${code}`)));
  });
  const stop = async () => {
    server.kill("SIGINT");
    assert.ok([0, 130].includes(await ended), "Ctrl-C ends it");
  };
  return { address, stop };
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
