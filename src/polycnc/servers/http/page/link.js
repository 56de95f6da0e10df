// The link to a machine: questions, commands, and the stream of what it shows.
import { say } from "/dom.js";
import { TEXTS } from "/texts.js";
import { Lease } from "/lease.js";

const OF_CHANNEL = ["select_mode", "select_program", "set_mdi", "search", "cycle_start", "feed_hold", "reset", "set_overrides", "set_switches", "set_breakpoints"];
// These are given one after the other, in the order of the presses; what brakes is given at once, and calls off those that wait.
const IN_TURN = ["select_mode", "select_program", "set_mdi", "search", "cycle_start"], BRAKES = ["feed_hold", "reset", "emergency_stop"];
const RATE = 25, STALE_MS = 700, LOOK_MS = 100, AGAIN_MS = 1000;

export class Link extends EventTarget {
  // Events: `message` (detail: what the stream tells), `status` (detail: a status), `lost`.
  constructor() {
    super();
    Object.assign(this, { name: "", channel: 0, parts: [], status: null, socket: null, seen: -Infinity, lost: true, number: 0, brakes: 0, last: Promise.resolve() });
    this.lease = new Lease(this);
    setInterval(() => { if (performance.now() - this.seen > STALE_MS) this.lose(); }, LOOK_MS);
  }

  has(part) { return this.parts.includes(part); }
  url(rest) { return `/api/machines/${encodeURIComponent(this.name)}/${rest}`; }
  tell(type, detail) { this.dispatchEvent(new CustomEvent(type, { detail })); }

  // The answer to a question; null if it is refused, undefined if it does not come, which is shown.
  async ask(rest, options, at = this.url(rest)) {
    try {
      const answer = await fetch(at, { ...options, headers: { "polycnc-key": this.lease.key } });
      if (answer.ok) return answer;
      const problem = await answer.json();
      say(`${problem.detail}. ${problem.hint}`);
      return null;
    } catch { say(TEXTS.lost); }
    return undefined;
  }
  async read(how, rest, options) {
    const answer = await this.ask(rest, options);
    return answer ? answer[how]().catch(() => say(TEXTS.lost)) : answer;
  }
  json(rest, options) { return this.read("json", rest, options); }
  text(rest) { return this.read("text", rest); }
  async send(method, rest, body, at) { return Boolean(await this.ask(rest, { method, body: typeof body === "string" ? body : JSON.stringify(body) }, at)); }
  async quietly(rest) {
    const answer = await fetch(this.url(rest)).catch(() => null);
    return answer?.ok ? answer.text().catch(() => null) : null;
  }

  // A question that tells whether the same machine and channel are looked at as now, and nobody has pressed what brakes.
  stays() {
    const { name, channel, brakes } = this;
    return () => this.name === name && this.channel === channel && this.brakes === brakes;
  }

  // A command as a function that gives it, whenever that is, to the machine and the channel that are looked at now. What is
  // commanded of a channel is of the one that is shown, where there are several. It tells the number of its answer, or 0.
  given(name, values = {}) {
    if (this.status?.channels?.length > 1 && OF_CHANNEL.includes(name)) values = { ...values, channel: this.channel };
    const of = this.name, at = this.url("commands"), body = JSON.stringify({ command: name, ...values });
    if (BRAKES.includes(name)) this.brakes++;
    const { brakes } = this;
    const give = async () => {
      const answer = await this.ask("commands", { method: "POST", body }, at), number = Number(answer?.headers.get("polycnc-number"));
      const status = answer && (await answer.json().catch(() => null));
      if (status && this.name === of) this.show(status, number); // another machine may have been chosen meanwhile
      return answer ? number : 0;
    };
    return IN_TURN.includes(name) ? () => (this.last = this.last.then(() => (this.brakes === brakes ? give() : 0))) : give;
  }
  async command(name, values) { return Boolean(await this.given(name, values)()); }

  // What was told earlier may arrive later: it is not shown any more.
  isLate(number) {
    const isLate = number < this.number;
    if (!isLate) this.number = number;
    return isLate;
  }
  show(status, number) {
    if (this.isLate(number)) return;
    this.status = status;
    this.tell("status", status);
  }

  connect() {
    this.leave();
    this.number = 0; // another process may answer now
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${this.url(`stream?rate=${RATE}`)}`);
    this.socket = socket;
    socket.onmessage = (event) => {
      if (this.socket !== socket) return; // of the machine before
      const message = JSON.parse(event.data);
      if (message.refused) { say(`${message.refused.detail}. ${message.refused.hint}`); return; }
      this.seen = performance.now();
      this.lost = false;
      message.isLate = message.number < this.number;
      this.tell("message", message);
      this.show(message.status, message.number);
    };
    socket.onclose = () => {
      if (this.socket !== socket) return;
      this.lose();
      setTimeout(() => { if (this.socket === socket) this.connect(); }, AGAIN_MS);
    };
  }
  lose() {
    if (this.lost) return;
    this.lost = true;
    this.tell("lost");
  }
  // Nothing of a machine may be shown after another one is chosen.
  leave() {
    const { socket } = this;
    this.socket = null;
    socket?.close();
  }
  jog(axis, direction, rapid, repeat = false) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify({ jog: { axis, direction, rapid, repeat }, key: this.lease.key }));
  }
}
