// A joint in the hand: asks as it is moved, and draws nothing that is older than what is drawn.
//
// While the hand moves, quick answers follow it, each from where the bodies were in the last one; once it rests the exact
// one is asked, of a worker of its own, and then once more from where the hand left the bodies: there may be another
// balance. Each worker is asked one question at a time, the newest: what the hand has passed by meanwhile is never asked.
// `send(question)` gets { ask, words, quick, from }, and `answered` gets each answer once, in whatever order they come;
// `show(answer, question)` what is to be drawn, with question.here: whether the hand is still there; `again(answer, exact)`
// the second of two exact answers of where the hand is, and the first.
"use strict";

class Hand {
  constructor(send, show, { again = () => {}, rest = 120, wait = (f, ms) => setTimeout(f, ms), end = (timer) => clearTimeout(timer) } = {}) {
    Object.assign(this, { send, show, again, rest, wait, end });
    this.count = 0;    // of questions
    this.place = 0;    // of the hand: counted
    this.shown = -1;   // what is drawn: twice its place, and one more where it is exact
    this.last = null;  // quick answer that has a solution: { bodies, place }
    this.exact = null; // answer of where the hand is
    this.workers = { quick: { asked: null, next: null }, exact: { asked: null, next: null } };
    this.timer = null;
  }
  // The hand is here. `words`: of `dea run`.
  move(words) {
    this.go(words);
    this.timer = this.wait(() => this.settle(words), this.rest);
  }
  // The hand is here and rests: a number was typed.
  set(words) {
    this.go(words);
    this.settle(words);
  }
  // Nothing is asked or shown any more.
  stop() {
    this.end(this.timer);
    this.send = this.show = this.again = () => {};
  }
  // Is what is drawn exact, and of where the hand is?
  get settled() { return this.shown === 2 * this.place + 1; }

  go(words) {
    this.end(this.timer);
    this.timer = null;
    this.exact = null;
    ++this.place;
    this.workers.exact.next = null;
    this.want("quick", words);
  }
  settle(words) {
    this.timer = null;
    this.want("exact", words);
  }
  want(kind, words, again = false) {
    this.workers[kind].next = { words, quick: kind === "quick", place: this.place, again };
    this.ask(this.workers[kind]);
  }
  ask(worker) {
    if (worker.asked || !worker.next) return;
    worker.asked = { ask: ++this.count, ...worker.next };
    worker.next = null;
    const { ask, words, quick, again } = worker.asked;
    this.send({ ask, words, quick, from: (quick || again) && this.last ? this.last.bodies : null });
  }
  answered(answer) {
    const worker = Object.values(this.workers).find((w) => w.asked && w.asked.ask === answer.ask);
    if (!worker) return;
    const question = worker.asked, here = question.place === this.place, what = 2 * question.place + (question.quick ? 0 : 1);
    worker.asked = null;
    if (question.quick) this.last = answer.text && answer.text.solved ? { bodies: answer.text.bodies, place: question.place } : null;
    if (!question.quick && !question.again && here) this.exact = answer;
    // once both are there, whichever came last
    if (!question.again && here && this.exact && this.exact.text && this.last && this.last.place === this.place) this.want("exact", question.words, true);
    this.ask(worker);  // it works while the answer is drawn
    if (question.again) {
      if (here && this.exact) this.again(answer, this.exact);
      return;
    }
    if (!(what > this.shown)) return;
    this.shown = what;
    this.show(answer, { ...question, here });
  }
}
