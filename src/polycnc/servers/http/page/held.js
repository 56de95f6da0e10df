// What an operator has just turned: it stays as he left it until what the machine shows is surely newer.
const OLDER_MS = 300; // a status that was sent before the command was carried out may come so long after its answer

export class Held {
  constructor() { Object.assign(this, { pending: 0, untilMs: -Infinity, last: Promise.resolve() }); }

  get holds() { return this.pending > 0 || performance.now() < this.untilMs; }

  // Commands are sent one after the other, in the order of the presses; each tells whether it has been carried out.
  send(command) {
    this.pending++;
    this.last = this.last.then(command).catch(() => false).then((isDone) => {
      this.pending--;
      this.untilMs = isDone ? performance.now() + OLDER_MS : -Infinity;
    });
  }
}
