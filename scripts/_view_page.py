"""The page of the browser viewer: no library, nothing from elsewhere."""

PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Soft hand</title>
<style>
body { font: 15px sans-serif; margin: 1em; display: flex; gap: 1.5em }
#side { width: 430px }
img { width: 640px; height: 480px; background: #ddd }
label { display: block; margin: .6em 0 } input { width: 320px; vertical-align: middle }
canvas { border: 1px solid #999; display: block }
</style></head><body>
<div><img id="picture" alt="the hand"></div>
<div id="side">
<div id="sliders"></div>
<p>Pressures [kPa gauge] of the last 10 s: <span style="color:#0072b2">thumb</span>,
<span style="color:#d55e00">index</span>, <span style="color:#009e73">middle, ring, little</span>; dashed: set</p>
<canvas id="plot" width="420" height="220"></canvas>
<p id="figures"></p>
</div>
<script src="/view.js"></script>
</body></html>
"""

SCRIPT = """"use strict";
const names = ["thumb", "index", "middle, ring, little"], colours = ["#0072b2", "#d55e00", "#009e73"];
const sliders = [], rows = [];
const wanted = new URLSearchParams(location.hash.slice(1)).get("angles");
function send() {
  const angles = sliders.map(s => Number(s.value));
  sliders.forEach((s, k) => { s.nextSibling.textContent = " " + angles[k] + " degrees"; });
  return fetch("/angles", {method: "POST", headers: {"Content-Type": "application/json"},
                           body: JSON.stringify({set_angle_deg: angles})});
}
function build(most) {
  names.forEach(name => {
    const label = document.createElement("label"), slider = document.createElement("input");
    Object.assign(slider, {type: "range", min: 0, max: most, step: 1, value: 0});
    label.append(name, document.createElement("br"), slider, document.createElement("output"));
    slider.addEventListener("input", send);
    document.getElementById("sliders").append(label);
    sliders.push(slider);
  });
  if (wanted) wanted.split(",").forEach((v, k) => { sliders[k].value = v; });
  return send();
}
function draw() {
  const canvas = document.getElementById("plot"), g = canvas.getContext("2d");
  g.clearRect(0, 0, canvas.width, canvas.height);
  if (!rows.length) return;
  const end = rows[rows.length - 1].time_s;
  const x = t => canvas.width * (1 - (end - t) / 10), y = p => canvas.height * (1 - p / 100e3);
  for (const [field, dash] of [["pressure_pa_gauge", []], ["set_pressure_pa_gauge", [4, 4]]]) {
    g.setLineDash(dash);
    colours.forEach((colour, k) => {
      g.strokeStyle = colour; g.beginPath();
      rows.forEach(r => g.lineTo(x(r.time_s), y(r[field][k])));
      g.stroke();
    });
  }
}
async function follow() {
  const state = await (await fetch("/state")).json();
  if (!sliders.length) await build(Math.floor(state.highest_angle_deg));
  rows.push(state);
  while (rows.length && rows[0].time_s < state.time_s - 10) rows.shift();
  document.getElementById("picture").src = "/picture.png?" + state.pictures;
  document.getElementById("figures").textContent = state.time_s.toFixed(1) + " s simulated; tips at " +
    state.tip_angle_deg.map(a => a.toFixed(0)).join(", ") + " degrees";
  document.body.dataset.tips = state.tip_angle_deg.join(" ");
  draw();
  setTimeout(follow, 150);
}
follow();
"""
