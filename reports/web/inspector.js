// SPDX-License-Identifier: BSD-3-Clause
// The frames at which the error of a run grew most, with what the odometry thought of their pictures.
"use strict";
(function (page) {
  const byId = (id) => document.getElementById(id);

  const growth = (series, frame) => {
    const grown = series.columns.growth_m ? series.columns.growth_m[frame] : null;
    return grown === null || grown === undefined ? "the pose is lost" : "error grew by " + (1000 * grown).toPrecision(3) + " mm";
  };

  // One button for each of the worst frames; onFrame(frame) hears them.
  page.inspector = function (onFrame) {
    let series = null, pictures = {};

    function list() {
      byId("worst-list").replaceChildren(...series.worst.map((frame) => {
        const item = page.element("li");
        const button = page.element("button", { type: "button", "data-frame": frame }, "frame " + frame + ": " + growth(series, frame));
        button.addEventListener("click", () => onFrame(frame));
        item.append(button);
        return item;
      }));
    }

    function show(frame) {
      const image = byId("picture"), jpeg = pictures[frame];
      const rank = series.worst.indexOf(frame);
      image.hidden = !jpeg;
      if (jpeg) image.src = "data:image/jpeg;base64," + jpeg;
      else image.removeAttribute("src");
      const place = rank < 0 ? "" : ", " + (rank + 1) + " of the " + series.worst.length + " worst, " + growth(series, frame);
      image.alt = "Annotated picture of frame " + frame + place;
      byId("picture-caption").textContent = "Frame " + frame + place + (jpeg ? "" : "; the page has no picture of it");
      for (const button of byId("worst-list").querySelectorAll("button"))
        button.toggleAttribute("aria-current", Number(button.dataset.frame) === frame);
      byId("runs").dataset.picture = jpeg ? frame : "";
    }

    return {
      select(run, ofRun) {
        series = ofRun;
        pictures = page.pictures(run);
        const carried = Object.keys(pictures).length, made = page.index.runs[run].pictures;
        byId("inspector").hidden = !series.worst.length;
        byId("picture-note").textContent = carried === 0 ? "No pictures of this run: they are kept of accuracy runs whose plan asks for pictures, and of none that are timed."
          : carried < made ? "The page has room for " + carried + " of the " + made + " pictures in the store." : "";
        list();
        if (series.worst.length) show(series.worst[0]);
      },
      show,
    };
  };
})(window.stillpoint);
