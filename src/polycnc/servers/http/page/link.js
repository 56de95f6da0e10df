// The link to a machine: questions, commands, and the stream of what it shows.
import { say } from "/dom.js";
import { TEXTS } from "/texts.js";
import { Lease } from "/lease.js";

const OF_CHANNEL = ["select_mode", "select_program", "set_mdi", "search", "cycle_start", "feed_hold", "reset", "set_overrides", "set_switches", "set_breakpoints"];
const RATE = 25, STALE_MS = 700, LOOK_MS = 100, AGAIN_MS = 1000;

export class Link extends EventTarget {
  // Events: `message` (detail: what the stream tells), `status` (detail: a status), `lost`.
  constructor() {
    super();
    Object.assign(this, { name: "", channel: 0, parts: [], status: null, socket: null, seen: -Infinity, lost: true });
    this.lease = new Lease(this);
    setInterval(() => { if (performance.now() - this.seen > STALE_MS) this.lose(); }, LOOK_MS);
  }

  has(part) { return this.parts.includes(part); }
  url(rest) { return `/api/machines/${encodeURIComponent(this.name)}/${rest}`; }
  tell(type, detail) { this.dispatchEvent(new CustomEvent(type, { detail })); }

  // The answer to a question; null if it is refused, which is shown.
  async ask(rest, options) {
    try {
      const answer = await fetch(this.url(rest), { ...options, headers: { "polycnc-key": this.lease.key } });
      if (answer.ok) return answer;
      const problem = await answer.json();
      say(`${problem.detail}. ${problem.hint}`);
    } catch { say(TEXTS.lost); }
    return null;
  }
  async json(rest, options) { const answer = await this.ask(rest, options); return answer ? answer.json() : null; }
  async send(method, rest, body) { return Boolean(await this.ask(rest, { method, body: typeof body === "string" ? body : JSON.stringify(body) })); }
  async quietly(rest) { const answer = await fetch(this.url(rest)).catch(() => null); return answer?.ok ? answer : null; }

  // What is commanded of a channel is of the one that is shown, where there are several.
  async command(name, values = {}) {
    if (this.status?.channels?.length > 1 && OF_CHANNEL.includes(name)) values = { ...values, channel: this.channel };
    const of = this.name, status = await this.json("commands", { method: "POST", body: JSON.stringify({ command: name, ...values }) });
    if (status && this.name === of) this.show(status); // another machine may have been chosen meanwhile
    return Boolean(status);
  }
  show(status) { this.status = status; this.tell("status", status); }

  connect() {
    this.leave();
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}${this.url(`stream?rate=${RATE}`)}`);
    this.socket = socket;
    socket.onmessage = (event) => {
      if (this.socket !== socket) return; // of the machine before
      const message = JSON.parse(event.data);
      if (message.refused) { say(`${message.refused.detail}. ${message.refused.hint}`); return; }
      this.seen = performance.now();
      this.lost = false;
      this.tell("message", message);
      this.show(message.status);
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
