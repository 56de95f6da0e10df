// What an operator has just turned: it stays as he left it until the machine has answered.
export class Held {
  // `since`: the number of the last answer; what was told before it is older.
  constructor() { Object.assign(this, { pending: 0, since: 0, last: Promise.resolve() }); }

  get holds() { return this.pending > 0; }

  // Commands are sent one after the other, in the order of the presses.
  send(command) {
    this.pending++;
    this.last = this.last.then(command).catch(() => 0).then((number) => {
      this.pending--;
      this.since = Math.max(this.since, number);
    });
  }
}
