// Hand (portable/page/hand.js) under answers in any order: node hand.js
"use strict";
const fs = require("fs"), path = require("path"), assert = require("assert");
const Hand = eval(fs.readFileSync(path.join(__dirname, "../page/hand.js"), "utf8") + "\nHand");

// A generator whose numbers are the same everywhere.
let seed = 1;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;

// Moves a hand with answers that come late and in any order; everything that is drawn, and the questions.
function walk(moves, seeded) {
  seed = seeded;
  let timers = [], waiting = [], clock = 0, number = 0, most = 0;
  const drawn = [], asked = [], twice = [], quick = new Map();
  const hand = new Hand((q) => { asked.push(q); waiting.push({ ...q, at: clock + 1 + Math.floor(random() * 300) }); most = Math.max(most, waiting.length); },
    (answer, q) => drawn.push({ ...q, text: answer.text.words }),
    { rest: 120, again: (answer, exact) => twice.push({ answer, exact, place: hand.place }), wait: (f, ms) => { timers.push({ f, at: clock + ms, number: ++number }); return number; }, end: (n) => { timers = timers.filter((t) => t.number !== n); } });
  const pass = (ms) => {
    for (const end = clock + ms; clock < end; ++clock) {
      for (const t of timers.filter((t) => t.at <= clock)) { timers = timers.filter((o) => o !== t); t.f(); }
      for (const a of waiting.filter((w) => w.at <= clock).sort(() => random() - 0.5)) {
        waiting = waiting.filter((w) => w !== a);
        const words = a.words.join(" "), solved = random() < 0.9;
        if (a.quick) quick.set(words, solved);
        hand.answered({ ask: a.ask, text: { words, solved, bodies: words } });
      }
    }
  };
  for (let i = 0; i < moves; ++i) { hand.move(["run", String(i)]); pass(Math.floor(random() * 40)); }
  pass(2000);
  return { hand, drawn, asked, most, timers, waiting, twice, quick };
}

for (const seeded of [1, 7, 42, 1234]) {
  const { hand, drawn, asked, most, timers, waiting, twice, quick } = walk(500, seeded);
  for (let k = 1; k < drawn.length; ++k)
    assert(2 * drawn[k].place + !drawn[k].quick > 2 * drawn[k - 1].place + !drawn[k - 1].quick, "an older answer was drawn over a newer one");
  for (const d of drawn) assert.strictEqual(d.text, `run ${d.place - 1}`, "an answer was drawn as that of another place");
  const last = drawn.at(-1);
  assert(hand.settled && !last.quick && last.place === 500 && last.here, "the last place has no exact answer");
  assert(most <= 2 && waiting.length === 0 && timers.length === 0, "more than one question at a time of a worker, or something is left");
  assert(asked.length < 500, "places that the hand had passed by were asked");
  assert(drawn.filter((d) => d.quick).length > 10, "nothing followed the hand");
  // a quick question starts from the last quick answer, if that is a solution, and an exact one from nothing
  let before = null;
  for (const q of asked) {
    if (q.quick) {
      assert.strictEqual(q.from, before && quick.get(before) ? before : null, "a quick question starts from elsewhere");
      before = q.words.join(" ");
    } else if (q.from !== null) {
      const same = asked.filter((o) => !o.quick && o.words.join() === q.words.join());
      assert(same.length === 2 && same[1] === q && same[0].from === null, "an exact question starts from the hand's last place");
    }
  }
  const end = "run 499", again = asked.some((q) => !q.quick && q.from === end);
  assert.strictEqual(again, quick.get(end), "where the hand rests there is a second search, if the coarse one has a solution");
  for (const t of twice) {
    assert.strictEqual(t.answer.text.words, t.exact.text.words, "two balances of different places");
    assert.strictEqual(t.answer.text.words, `run ${t.place - 1}`, "balances of a place that the hand has left");
  }
}

// an answer that nobody waits for changes nothing
{
  const drawn = [], hand = new Hand(() => {}, (a) => drawn.push(a), { wait: () => 0, end: () => {} });
  hand.set(["run"]);
  hand.answered({ ask: 99 });
  assert.strictEqual(drawn.length, 0);
  hand.answered({ ask: 2, text: "exact" });
  hand.answered({ ask: 1, text: "quick" });
  assert.deepStrictEqual(drawn.map((a) => a.text), ["exact"]);
}
console.log("hand: passed");
