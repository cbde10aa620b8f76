"use strict";
const svg = document.querySelector("svg.mech9"), scene = svg.querySelector("#scene");
const button = document.getElementById("play"), slider = document.getElementById("frame");
const speed = document.getElementById("speed"), clock = svg.querySelector("#time");
const elements = [], nodes = film.links.length, xy = new Float64Array(2*nodes), depth = new Float64Array(nodes);
for (const g of scene.children) elements[g.dataset.i - 1] = g;
let view = film.view.slice(), shown = 0, playing = false, phase = 0, before = null, waiting = 0, order = "";

// where the nodes of a frame stand: turned with their links by quaternions, then seen
function place(frame) {
  const poses = film.poses[frame], unit = film.unit*film.scale;
  for (let i = 0; i < nodes; i++) {
    let x = film.points[3*i], y = film.points[3*i + 1], z = film.points[3*i + 2];
    const at = 7*(film.links[i] - 1);
    if (at >= 0) {
      const w = poses[at + 3]/1e5, a = poses[at + 4]/1e5, b = poses[at + 5]/1e5, c = poses[at + 6]/1e5;
      const p = 2*(b*z - c*y), q = 2*(c*x - a*z), r = 2*(a*y - b*x);
      x += w*p + b*r - c*q + poses[at];
      y += w*q + c*p - a*r + poses[at + 1];
      z += w*r + a*q - b*p + poses[at + 2];
    }
    xy[2*i] = film.middle[0] + unit*(view[0]*x + view[1]*y + view[2]*z);
    xy[2*i + 1] = film.middle[1] - unit*(view[3]*x + view[4]*y + view[5]*z);
    depth[i] = unit*(view[6]*x + view[7]*y + view[8]*z);
  }
}

const at = (x, y) => x.toFixed(2) + " " + y.toFixed(2);

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

function windings(thread, [a, b]) {
  const x = xy[2*a], y = xy[2*a + 1], dx = xy[2*b] - x, dy = xy[2*b + 1] - y, length = Math.hypot(dx, dy) || 1;
  const turns = 2*(thread ? Math.max(3, Math.min(60, Math.round(length/(6*film.symbol)))) : 10);
  const height = (thread ? 3.5 : 6)*film.symbol/length, lead = thread ? 0 : 0.2;
  let d = "M" + at(x, y);
  for (let i = 0; i <= turns; i++) {
    const along = lead + (1 - 2*lead)*i/turns, side = i == 0 || i == turns ? 0 : height*(1 - 2*(i % 2));
    d += "L" + at(x + along*dx - side*dy, y + along*dy + side*dx);
  }
  return d + "L" + at(x + dx, y + dy);
}

// bodies from the farthest to the nearest, but none before those that it lies upon
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

function draw(frame, all) {
  shown = frame;
  place(frame);
  film.items.forEach((item, i) => {
    if (!all && item.still) return;
    const g = elements[i], n = item.nodes;
    if (item.shape >= 5) {
      const scale = item.shape == 5 ? ") scale(" + film.symbol : "";
      g.setAttribute("transform", "translate(" + at(xy[2*n[0]] + item.shift[0], xy[2*n[0] + 1] + item.shift[1])
        + scale + ")");
    } else {
      const d = item.shape == 4 ? windings(item.thread, n) : path(item.shape, n);
      for (const line of g.children) line.setAttribute("d", d);
    }
  });
  arrange();
  slider.value = frame;
  clock.textContent = "t = " + Number(film.times[frame].toPrecision(4)) + " s";
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

// a film of less than 3 s is slowed down, one of more than 15 s made faster
const span = film.times[film.times.length - 1] - film.times[0];
const length = Math.min(15, Math.max(3, Math.abs(span)));

// Time is told by the frames alone: the first one after a start or a pause says from when on, whatever other
// clocks say; after a second without frames, as in a tab that nobody sees, the film goes on where it was.
function tick(now) {
  if (!playing) return;
  if (before !== null) {
    const passed = now - before;
    if (passed > 0 && passed < 1000) phase = (phase + passed/1000/length*speed.value) % 1;
  }
  before = now;
  const frame = Math.min(film.times.length - 1, Math.floor(phase*film.times.length));
  if (frame != shown) draw(frame);
  waiting = requestAnimationFrame(tick);
}

function play(on) {
  playing = on && film.times.length > 1;
  button.textContent = playing ? "Pause" : "Play";
  cancelAnimationFrame(waiting);
  before = null;
  if (playing) waiting = requestAnimationFrame(tick);
}

function show(frame) {
  play(false);
  phase = frame/film.times.length;
  draw(frame);
}

// turns the view about the picture's own axes
function turn(aside, upward) {
  for (const [i, j, angle] of [[0, 6, aside], [3, 6, upward]]) {
    const c = Math.cos(angle), s = Math.sin(angle);
    for (let k = 0; k < 3; k++) {
      const a = view[i + k], b = view[j + k];
      view[i + k] = c*a + s*b;
      view[j + k] = c*b - s*a;
    }
  }
  draw(shown, true);
  drawAxes();
}

slider.max = film.times.length - 1;
slider.addEventListener("input", () => show(Number(slider.value)));
button.addEventListener("click", () => play(!playing));
document.getElementById("names").addEventListener("change", event =>
  svg.classList.toggle("bare", !event.target.checked));
document.getElementById("home").addEventListener("click", () => { view = film.view.slice(); turn(0, 0); });
document.addEventListener("keydown", event => {
  if (event.target.tagName == "SELECT" || event.target.tagName == "BUTTON") return;
  const frames = film.times.length;
  if (event.key == " ") play(!playing);
  else if (event.key == "ArrowRight") show((shown + 1) % frames);
  else if (event.key == "ArrowLeft") show((shown + frames - 1) % frames);
  else return;
  event.preventDefault();
});
let held = false;
svg.addEventListener("pointerdown", event => { held = true; svg.setPointerCapture(event.pointerId); });
svg.addEventListener("pointerup", () => { held = false; });
svg.addEventListener("pointermove", event => {
  if (held) turn(event.movementX/150, -event.movementY/150);
});
turn(0, 0);
play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
