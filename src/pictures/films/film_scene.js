"use strict";
const svg = document.querySelector("svg.mech9"), scene = svg.querySelector("#scene");
const frames = film.times.length, nodes = film.links.length, elements = [];
const xy = new Float64Array(2*nodes), depth = new Float64Array(nodes);
for (const g of scene.children) elements[g.dataset.i - 1] = g;

// The view and its state; `zoom` and `aside` are relative to a picture drawn by `film.scale` around `film.middle`.
let view = film.view.slice(), zoom = 1, aside = [0, 0], letters = 1, shown = 0, order = "";

// The places of the nodes in a frame: quaternions turn them with their links, and the view projects them. The square of the
// length of a quaternion is a factor, 1 but for arrows round an axis.
function place(frame) {
  const poses = film.poses[frame], unit = film.unit*film.scale;
  for (let i = 0; i < nodes; i++) {
    let x = film.points[3*i], y = film.points[3*i + 1], z = film.points[3*i + 2];
    const at = 7*(film.links[i] - 1);
    if (at >= 0) {
      const w = poses[at + 3]/1e5, a = poses[at + 4]/1e5, b = poses[at + 5]/1e5, c = poses[at + 6]/1e5;
      const s = w*w - a*a - b*b - c*c, d = 2*(a*x + b*y + c*z), e = 2*w;
      const p = b*z - c*y, q = c*x - a*z, r = a*y - b*x;
      x = s*x + d*a + e*p + poses[at];
      y = s*y + d*b + e*q + poses[at + 1];
      z = s*z + d*c + e*r + poses[at + 2];
    }
    xy[2*i] = film.middle[0] + unit*(view[0]*x + view[1]*y + view[2]*z);
    xy[2*i + 1] = film.middle[1] - unit*(view[3]*x + view[4]*y + view[5]*z);
    depth[i] = unit*(view[6]*x + view[7]*y + view[8]*z);
  }
}

const at = (x, y) => x.toFixed(zoom > 3 ? 4 : 2) + " " + y.toFixed(zoom > 3 ? 4 : 2);

function path(shape, n) {
  let d = "", area = 0;
  for (let i = 0; i < n.length; i++) {
    const a = n[i], b = n[(i + 1) % n.length];
    d += (i == 0 || (shape == 3 && i % 2 == 0) ? "M" : "L") + at(xy[2*a], xy[2*a + 1]);
    area += xy[2*a]*xy[2*b + 1] - xy[2*a + 1]*xy[2*b];
  }
  if (shape == 2 && area > -2e-3) return "";
  return shape == 1 || shape == 2 ? d + "Z" : d;
}

function windings(thread, [a, b], aside) {
  const x = xy[2*a], y = xy[2*a + 1], dx = xy[2*b] - x, dy = xy[2*b + 1] - y;
  const length = Math.hypot(dx, dy) || 1;
  const turns = 2*(thread ? Math.max(3, Math.min(60, Math.round(length/(6*film.symbol)))) : 10);
  const height = (thread ? 3.5 : 6)*film.symbol/length, lead = thread ? 0 : 0.2, shift = aside*film.symbol/length;
  let d = "M" + at(x, y);
  for (let i = 0; i <= turns; i++) {
    const along = lead + (1 - 2*lead)*i/turns, side = shift + (i == 0 || i == turns ? 0 : height*(1 - 2*(i % 2)));
    d += "L" + at(x + along*dx - side*dy, y + along*dy + side*dx);
  }
  return d + "L" + at(x + dx, y + dy);
}

// A cup with a piston in it: every two places are a line, each given along the axis and to the side.
const cup = [[0, 0], [0.42, 0], [0.42, -1], [0.42, 1], [0.42, -1], [0.66, -1], [0.42, 1], [0.66, 1], [0.56, -0.7], [0.56, 0.7],
  [0.56, 0], [1, 0]];

function damper([a, b], aside) {
  const x = xy[2*a], y = xy[2*a + 1], dx = xy[2*b] - x, dy = xy[2*b + 1] - y, unit = film.symbol/(Math.hypot(dx, dy) || 1);
  return cup.map(([along, side], i) => {
    const s = along == 0 || along == 1 ? 0 : unit*(aside + 5*side);
    return (i % 2 ? "L" : "M") + at(x + along*dx - s*dy, y + along*dy + s*dx);
  }).join("");
}

// The bodies are put in order from the farthest to the nearest, but none before those that it lies upon.
function arrange() {
  const [first, last] = film.sorted, keys = [];
  for (let i = first; i <= last; i++) {
    const item = film.items[i - 1];
    keys[i] = Math.round(0.5*item.nodes.reduce((sum, n) => sum + depth[n], 0)/item.nodes.length);
    for (const j of item.above) keys[i] = Math.max(keys[i], keys[j]);
  }
  const sorted = film.items.map((item, i) => i + 1).slice(first - 1, last);
  sorted.sort((a, b) => keys[a] - keys[b] || a - b);
  if (sorted.join() == order) return;
  order = sorted.join();
  const next = elements[last] || null;
  for (const i of sorted) scene.insertBefore(elements[i - 1], next);
}

// Labels keep their size when the picture is zoomed, and grow on a small page; their distances never shrink.
function drawItem(g, item) {
  const n = item.nodes, x = xy[2*n[0]], y = xy[2*n[0] + 1];
  if (item.shape == 6) {
    const size = letters/zoom, far = Math.max(1, size);
    g.setAttribute("transform",
      "translate(" + at(x + far*item.shift[0], y + far*item.shift[1]) + ") scale(" + size + ")");
  } else if (item.shape == 5) {
    g.setAttribute("transform", "translate(" + at(x, y) + ") scale(" + film.symbol + ")");
  } else {
    const d = item.damper ? damper(n, item.shift[0])
      : item.shape == 4 ? windings(item.thread, n, item.shift[0]) : path(item.shape, n);
    for (const line of g.getElementsByTagName("path")) line.setAttribute("d", d);
  }
}

// Some items are shown only while a state holds, such as that a stop pushes.
const passing = film.items.map((item, i) => i).filter(i => film.items[i].state);

function showStates(frame) {
  for (const i of passing)
    elements[i].setAttribute("visibility", film.holds[film.items[i].state - 1][frame] == "1" ? "visible" : "hidden");
}

// A frame is drawn; with `all` also the items that stand still, since the view has changed.
function drawScene(frame, all) {
  shown = frame;
  place(frame);
  film.items.forEach((item, i) => { if (all || !item.still) drawItem(elements[i], item); });
  showStates(frame);
  arrange();
}

function drawAxes() {
  const axes = svg.querySelector("#axes");
  "xyz".split("").forEach((name, i) => {
    const x = 26*view[i], y = -26*view[3 + i], line = axes.children[2*i], text = axes.children[2*i + 1];
    line.setAttribute("d", "M0 0L" + at(x, y));
    text.setAttribute("x", 1.36*x);
    text.setAttribute("y", 1.36*y);
    text.textContent = Math.hypot(x, y) < 2 ? "" : name;
  });
}

// The bar of the scale is the longest one of 1, 2, 5, 10, ... units that is at most 90 px long.
function drawScale() {
  const [line, text] = svg.querySelector("#scale").children, unit = film.length*film.scale*zoom, most = 90/unit;
  const power = 10**Math.floor(Math.log10(most) + 1e-9);
  const bar = [5, 2, 1].find(part => part*power <= most*(1 + 1e-9))*power;
  const length = bar*unit, box = svg.viewBox.baseVal;
  line.setAttribute("d", "M" + at(box.width - 90 - length, box.height - 19) + "v5h" + length.toFixed(2) + "v-5");
  text.textContent = Number(bar.toPrecision(3)) + " " + film.lengthUnit;
}

// The whole present frame is drawn, after a change of the view.
function drawView() {
  const box = svg.viewBox.baseVal;
  scene.setAttribute("transform", "translate(" + aside.map(x => x.toFixed(2)).join(" ") + ") scale(" + zoom + ")");
  letters = Math.max(1, Math.min(2, 0.85*box.width/(svg.clientWidth || box.width)));
  svg.style.setProperty("--text", letters);
  svg.style.setProperty("--zoom", zoom);
  drawScene(shown, true);
  drawAxes();
  drawScale();
}

// The view is turned about the axes of the picture.
function turn(sideways, upward) {
  for (const [i, j, angle] of [[0, 6, sideways], [3, 6, upward]]) {
    const c = Math.cos(angle), s = Math.sin(angle);
    for (let k = 0; k < 3; k++) {
      const a = view[i + k], b = view[j + k];
      view[i + k] = c*a + s*b;
      view[j + k] = c*b - s*a;
    }
  }
  drawView();
}

// The picture is moved, by px of the picture.
function move(x, y) {
  aside = [aside[0] + x, aside[1] + y];
  drawView();
}

// The picture is enlarged around one of its places, which stays where it is.
function zoomAt(factor, x = film.middle[0], y = film.middle[1]) {
  const next = Math.max(0.25, Math.min(20, zoom*factor)), by = next/zoom;
  aside = [x - by*(x - aside[0]), y - by*(y - aside[1])];
  zoom = next;
  drawView();
}

function resetView() {
  view = film.view.slice();
  zoom = 1;
  aside = [0, 0];
  drawView();
}
