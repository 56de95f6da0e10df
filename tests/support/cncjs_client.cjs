// A page of CNCjs, as its server sees one: it opens a port, sends a program and waits until it is over; each answer is a line of JSON.
const io = require("socket.io-client");
const [url, port, program] = process.argv.slice(2);
const say = (name, value) => console.log(JSON.stringify([name, value]));

async function main() {
  const { token } = await (await fetch(`${url}/api/signin`, { method: "POST", headers: { "content-type": "application/json" }, body: '{"token": ""}' })).json();
  const socket = io.connect(url, { query: `token=${token}` });
  const next = (name, holds = () => true) => new Promise((resolve) => {
    const look = (...values) => { if (holds(...values)) { socket.off(name, look); resolve(values); } };
    socket.on(name, look);
  });
  const command = (...values) => new Promise((resolve) => socket.emit("command", port, ...values, (error) => resolve(error ?? null)));
  socket.on("serialport:read", (line) => { if (/^(error|ALARM)/.test(line)) say("refused", line); });
  await next("startup");
  const idle = next("controller:state", (_, state) => state.status?.activeState === "Idle" && state.parserstate?.modal?.units);
  const settings = next("controller:settings", (_, all) => all.settings?.$32 !== undefined);
  socket.emit("open", port, { controllerType: "Grbl", baudrate: 115200 });
  say("modal", (await idle)[1].parserstate.modal.units);
  say("fastest", (await settings)[1].settings.$110);
  say("load", await command("gcode:load", "part.nc", program.replaceAll("|", "\n")));
  const over = next("sender:status", (status) => status.total > 0 && status.finishTime > 0);
  const rest = next("controller:state", (_, state) => state.status?.activeState === "Idle" && Number(state.status.mpos.x) === 7.5);
  socket.emit("command", port, "gcode:start");
  const [status] = await over;
  say("sent", [status.total, status.sent, status.received]);
  say("position", (await rest)[1].status.mpos);
  socket.emit("close", port);
  await next("serialport:close");
  process.exit(0);
}
main().catch((error) => { console.error(error); process.exit(1); });
