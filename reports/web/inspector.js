// SPDX-License-Identifier: BSD-3-Clause
// Worst frames of a run, by frame-to-frame error, with their annotated images.
"use strict";
(function (page) {
  const byId = (id) => document.getElementById(id);

  const errorText = (series, frame) => {
    const column = series.columns.frame_to_frame_error_m, error = column ? column[frame] : null;
    return error === null || error === undefined ? "tracking lost" : (1000 * error).toPrecision(3) + " mm";
  };

  // One button per worst frame; calls onFrame(frame) when it is pressed.
  page.inspector = function (onFrame) {
    let series = null, images = {};

    function list() {
      byId("worst-list").replaceChildren(...series.worst.map((frame) => {
        const item = page.element("li");
        const button = page.element("button", { type: "button", "data-frame": frame }, "frame " + page.frameNumber(series, frame) + ": " + errorText(series, frame));
        button.addEventListener("click", () => onFrame(frame));
        item.append(button);
        return item;
      }));
    }

    function show(frame) {
      const image = byId("frame-image"), jpeg = images[frame];
      const rank = series.worst.indexOf(frame);
      image.hidden = !jpeg;
      if (jpeg) image.src = "data:image/jpeg;base64," + jpeg;
      else image.removeAttribute("src");
      const place = rank < 0 ? "" : ", " + (rank + 1) + " of the " + series.worst.length + " worst by frame-to-frame error, " + errorText(series, frame);
      image.alt = "Annotated image of frame " + page.frameNumber(series, frame) + place;
      byId("frame-caption").textContent = "Frame " + page.frameNumber(series, frame) + place + (jpeg ? "" : "; no image embedded");
      for (const button of byId("worst-list").querySelectorAll("button"))
        button.toggleAttribute("aria-current", Number(button.dataset.frame) === frame);
      byId("runs").dataset.image = jpeg ? frame : "";
    }

    return {
      select(run, ofRun) {
        series = ofRun;
        images = page.images(run);
        const embedded = Object.keys(images).length, stored = page.index.runs[run].images;
        byId("inspector").hidden = !series.worst.length;
        byId("image-note").textContent = embedded === 0 ? "No annotated images of this run. Images are stored for accuracy runs of plans that set `images`, never for timing runs."
          : embedded < stored ? "The page contains " + embedded + " of the " + stored + " images in the store to limit its size." : "";
        list();
        if (series.worst.length) show(series.worst[0]);
      },
      show,
    };
  };
})(window.stillpoint);
