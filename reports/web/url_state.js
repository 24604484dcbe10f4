// SPDX-License-Identifier: BSD-3-Clause
// The state of the page in the fragment of its address: #metric=...&compare=KEY.KEY&run=KEY&frame=12&theme=dark.
"use strict";
(function (page) {
  const appliers = [];
  let values = new URLSearchParams(), applying = false;

  // A fragment without "=" is the name of a section.
  const fromHash = () => new URLSearchParams(location.hash.includes("=") ? location.hash.slice(1) : "");

  page.stateOf = (name) => values.get(name);

  // Changes some values; null, "" and false remove one. A step of the history is added if `isStep`.
  page.setState = function (changes, isStep) {
    if (applying) return;
    for (const [name, value] of Object.entries(changes)) {
      if (value === null || value === "" || value === false) values.delete(name); else values.set(name, value);
    }
    const text = values.toString();
    if (location.hash.slice(1) === text) return;
    history[isStep ? "pushState" : "replaceState"](null, "", "#" + text);
  };

  // `applier` is called at the start and after each step back or forward.
  page.onState = (applier) => appliers.push(applier);

  function apply() {
    values = fromHash();
    applying = true;
    for (const applier of appliers) applier();
    applying = false;
  }

  page.startState = function () {
    apply();
    window.addEventListener("popstate", () => { if (location.hash === "" || location.hash.includes("=")) apply(); });
  };
})(window.stillpoint);
